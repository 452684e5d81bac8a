"""A flight by hand: tests of one axis from level flight, each a 3-2-1-1 or a doublet of one control."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.at_once.body import Body
from benchmarks.at_once.flight import US_PER_RAD, Flown
from benchmarks.at_once.motion import STEP_S, Floats, level_state

from .motion import flown

CONTROLS = ("elevator", "aileron", "rudder")
_PATTERNS = ((3.0, -2.0, 1.0, -1.0), (1.0, -1.0))
"""Steps of a 3-2-1-1 and of a doublet, in time units; the sign is that of the deflection."""
_SHARES = (0.6, 1.0, 1.3)
"""Sizes of the tests, over the typical one."""
_REST_S = 3.0
"""Least free response after an input, s."""
_REMNANT_S = 0.3
"""Correlation time of the hands' remnant (McRuer and Krendel, AGARDograph 188), s."""
_HANDS_DELAY_S = 0.16


@dataclass(frozen=True)
class Servos:
    """Servos of the three surfaces, which the aircraft file may state otherwise."""

    lags_s: Mapping[str, float]
    rates_rad_s: Mapping[str, float] = field(default_factory=dict)
    plays_rad: Mapping[str, float] = field(default_factory=dict)
    delay_s: float = 0.0

    @property
    def table(self) -> Floats:
        """Shape (3, 3): lag, largest rate and play of each surface."""
        return np.array([
            [self.lags_s[c], self.rates_rad_s.get(c, 1e3), self.plays_rad.get(c, 0.0)] for c in CONTROLS
        ])  # fmt: skip


@dataclass(frozen=True)
class Input:
    """Input of one control."""

    control: int
    begin_s: float
    steps: tuple[tuple[float, float], ...]
    """Length, s, and deflection, rad, of each step."""

    @property
    def end_s(self) -> float:
        """Time of the last step, s."""
        return self.begin_s + sum(length for length, _ in self.steps)


def inputs_of(body: Body, axis: str, rng: np.random.Generator) -> list[Input]:
    """Draw seven to ten tests of one axis, whose units fit the aircraft's modes."""
    d = body.derivatives(body.speed)
    pitch, yaw = body.short_period_s / (2.0 * np.pi), 1.0 / np.sqrt(d["N_beta"])
    units = np.clip([1.6 * pitch, 1.0 * yaw, 1.9 * yaw], 0.1, 1.0)
    sizes = np.array([
        0.06 * min(abs(d["M_alpha"] / d["M_delta_e"]), 1.2), 0.4 * abs(d["L_p"] / d["L_delta_a"]),
        0.06 * d["N_beta"] / abs(d["N_delta_r"]),
    ])  # fmt: skip
    tests, at_s = [], 6.0
    for number in range(int(rng.integers(7, 11))):
        control = 0 if axis == "pitch" else 1 + number % 2
        pattern = _PATTERNS[(number // (1 if axis == "pitch" else 2)) % 2]
        unit = units[control] * rng.uniform(0.85, 1.2)
        size = sizes[control] * rng.choice(_SHARES) * rng.choice([-1.0, 1.0])
        size *= 0.5 if control == 1 and len(pattern) == 4 else 1.0
        steps = tuple((abs(units) * unit, float(np.sign(units) * size)) for units in pattern)
        tests.append(Input(control, at_s, steps))
        at_s = tests[-1].end_s + max(_REST_S, 5.0 * unit) + rng.uniform(3.0, 6.0)
    return tests


def fly(
    body: Body, tests: Sequence[Input], servos: Servos, gust_m_s: float, rng: np.random.Generator
) -> Flown:
    """Fly tests with the hands on every control whose own test does not run."""
    last = tests[-1]
    t = np.arange(0.0, last.end_s + 8.0, STEP_S)
    asked, hands = np.zeros((len(t), 3)), np.ones((len(t), 3))
    for test in tests:
        hands[(t >= test.begin_s) & (t < test.end_s + _REST_S), test.control] = 0.0
        at_s = test.begin_s
        for length, level in test.steps:
            asked[(t >= at_s) & (t < at_s + length), test.control] = level
            at_s += length
    d = body.derivatives(body.speed)
    roll = abs(d["L_p"] / d["L_delta_a"])
    gains = np.array([
        0.25 * abs(d["M_alpha"] / d["M_delta_e"]), 0.2 * abs(d["M_q"] / d["M_delta_e"]), 0.4 * roll,
        0.1 * roll, 0.3 / body.speed, _HANDS_DELAY_S,
    ])  # fmt: skip
    size = np.max(np.abs(asked[:, 0])) or 0.02
    remnant = 0.06 * size * rng.uniform(0.5, 1.5) * _coloured(rng, len(t), _REMNANT_S)
    scales = np.array([3.0, 3.0, 1.0]) * body.pitching.chord_m * 8.0 / body.speed
    gusts = gust_m_s * np.column_stack([_coloured(rng, len(t), s)[:, 0] for s in scales])
    trim = np.array([body.alpha, body.elevator])
    states, forces, pulses = flown(
        level_state(body.speed, body.alpha), asked, hands, remnant * [1.0, 1.0, 0.3], gains, trim,
        servos.table, servos.delay_s, gusts, US_PER_RAD, body.numbers,
    )  # fmt: skip
    seen = states.copy()
    seen[:, :3] -= gusts
    return Flown(t, seen, forces, pulses, ())


def _coloured(rng: np.random.Generator, count: int, memory_s: float) -> Floats:
    """Return noise of first order and unit size, shape (count, 3)."""
    from scipy.signal import lfilter

    kept = float(np.exp(-STEP_S / memory_s))
    white = rng.standard_normal((count, 3)) * np.sqrt(1.0 - kept**2)
    return np.asarray(lfilter([1.0], [1.0, -kept], white, axis=0))
