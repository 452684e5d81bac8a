"""Test inputs that an autopilot flies: their steps or sines, lengths and controls.

Deflections have the aircraft file's signs. A positive elevator is trailing edge down, a positive aileron
rolls to the left, a positive rudder yaws to the left. The inputs begin with nose up or to the right, and
reverse inputs with nose down.

In an orthogonal multisine each control has harmonics of its own of one base frequency. Over the whole length
the inputs are then uncorrelated. The phases keep the peaks low by clipping, and a shift in time makes every
input begin and end at zero. Source: Klein and Morelli, *Aircraft System Identification*, Sec. 9.3. Van der
Ouderaa, Schoukens and Renneboog 1988 describe the clipping.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from advisor.decision.inputs import SHORTEST_UNIT_S
from advisor.process.arrays import FloatArray
from advisor.scripts.pace import Pace

_MOST_LINES = 7
"""Number of harmonics of one control. Seven harmonics on each of three controls gave 20 derivatives within 6
%.
"""
_STARTS = 4
"""Number of sets of phases from which the clipping begins: Schroeder's, and random ones of a fixed seed. The
clipping ends in a local minimum, and the best of four has a relative peak factor below 1.25."""
_CLIPPINGS = 60
"""Number of clippings from each start. The peaks of seven harmonics hardly fall after about 50."""
_CLIPPED = (0.75, 0.99)
"""First and last level of the clipping, as shares of the peak. The level rises with each clipping."""
_SAMPLES = 16
"""Samples for each period of the highest harmonic. A peak exceeds the samples by at most 2 %."""


@dataclass(frozen=True, slots=True)
class Multisine:
    """Sum of harmonics of equal power on one control, with a peak of 1."""

    harmonics: tuple[int, ...]
    """Number of periods of each sine within the multisine's length."""
    amplitude: float
    """Amplitude of every sine for which the peak of the sum is 1."""
    phases_rad: tuple[float, ...]

    def values(self, share: FloatArray) -> FloatArray:
        """Return the values at times that are given as shares of the length, shape (n,)."""
        turns = 2.0 * np.pi * np.outer(share, self.harmonics) + np.array(self.phases_rad)
        return np.asarray(self.amplitude * np.sin(turns).sum(axis=1))


def disjoint_harmonics(lowest: int, highest: int, controls: int) -> tuple[tuple[int, ...], ...]:
    """Return the harmonics of each control, which alternate from ``lowest`` to about
    ``highest``. An even spacing allows lower peaks.

    Raises
    ------
    ValueError
        The band has less than two harmonics for each control.
    """
    count = (highest - lowest) // controls + 1
    if count < 2:
        raise ValueError(f"harmonics {lowest} to {highest} are too few for {controls} controls")
    wanted = _MOST_LINES * controls
    step = max(1, round((highest - lowest) / (wanted - 1)))
    numbers = np.arange(lowest, highest + step + 1, step)[:wanted]
    numbers = numbers[: controls * (len(numbers) // controls)]
    return tuple(tuple(int(n) for n in numbers[k::controls]) for k in range(controls))


@cache
def multisine(harmonics: tuple[int, ...]) -> Multisine:
    """Return a multisine of low peaks that begins and ends at zero."""
    numbers = np.array(harmonics)
    share = _grid(harmonics)
    random = np.random.default_rng(len(numbers))
    starts = [_schroeder(len(numbers))]
    starts += [random.uniform(-np.pi, np.pi, len(numbers)) for _ in range(_STARTS - 1)]
    clipped = [phases for start in starts for phases in _clipping(numbers, start, share)]
    best = min(clipped, key=lambda phases: _relative_peak_factor(_sum(numbers, phases, share)))
    return _begun_at_zero(numbers, best, share)


def _clipping(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> Iterator[FloatArray]:
    """Yield the phases after each clipping. The phases of a clipped sum give the sum lower peaks."""
    for level in np.linspace(*_CLIPPED, _CLIPPINGS):
        yield phases
        y = _sum(numbers, phases, share)
        peak = level * float(np.max(np.abs(y)))
        phases = np.angle(np.fft.rfft(np.clip(y, -peak, peak))[numbers]) + np.pi / 2.0


def _sum(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> FloatArray:
    return np.asarray(np.sin(2.0 * np.pi * np.outer(share, numbers) + phases).sum(axis=1))


def _grid(harmonics: Sequence[int]) -> FloatArray:
    return np.arange(n := _SAMPLES * max(harmonics)) / n


def _schroeder(count: int) -> FloatArray:
    """Return phases for equal power, -π k (k - 1) / count with k from 1 (Schroeder 1970)."""
    k = np.arange(1, count + 1)
    return np.asarray(-np.pi * k * (k - 1) / count)


def _relative_peak_factor(y: FloatArray) -> float:
    return float(np.ptp(y) / (2.0 * np.sqrt(2.0) * np.sqrt(np.mean(y**2))))


def _begun_at_zero(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> Multisine:
    """Return the sum shifted in time to the zero crossing with the least offset of the integral.

    The shift keeps power, peaks and orthogonality. The bank is the integral of the roll rate. Without an
    offset the bank swings about its value before the input.
    """
    y = _sum(numbers, phases, share)
    crossings = np.flatnonzero(np.sign(y) != np.sign(np.roll(y, -1)))
    offsets = np.cos(2.0 * np.pi * np.outer(share[crossings], numbers) + phases) @ (1.0 / numbers)
    nearest = int(crossings[np.argmin(np.abs(offsets))])
    best = phases + 2.0 * np.pi * numbers * _crossing(numbers, phases, share, nearest)
    return Multisine(
        tuple(int(n) for n in numbers),
        1.0 / float(np.max(np.abs(y))),
        tuple(float(phase) for phase in np.angle(np.exp(1j * best))),
    )


def _crossing(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray, k: int) -> float:
    """Return the time of the zero crossing after sample ``k``, as a share of the length."""
    low, high = share[k], share[k] + 1.0 / len(share)
    rises = float(_sum(numbers, phases, np.array([low]))[0]) < 0.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = (float(_sum(numbers, phases, np.array([middle]))[0]) < 0.0) == rises
        low, high = (middle, high) if before else (low, middle)
    return float(low)


Control = Literal["elevator", "aileron", "rudder"]
CONTROLS: tuple[Control, ...] = ("elevator", "aileron", "rudder")

Steps = tuple[tuple[float, float], ...]
"""Steps of one control: duration in time units, and share of the size."""

_3_2_1_1: Steps = ((3.0, -2.0 / 3.0), (2.0, 1.0), (1.0, -11.0 / 12.0), (1.0, 11.0 / 12.0))
"""The modified 3-2-1-1 of the paper, nose up first: steps of 0.8, 1.2, 1.1 and 1.1, divided by the largest.
Both pairs of steps have equal areas, so that the aircraft returns to trim without a pilot."""
_DOUBLET: Steps = ((1.0, -1.0), (1.0, 1.0))
_1_2_1: Steps = ((1.0, -1.0), (2.0, 1.0), (1.0, -1.0))

STEPPED: Mapping[str, tuple[Control, Steps]] = {
    "3-2-1-1": ("elevator", _3_2_1_1),
    "reverse 3-2-1-1": ("elevator", tuple((units, -share) for units, share in _3_2_1_1)),
    "aileron doublet": ("aileron", _DOUBLET),
    "rudder doublet": ("rudder", _DOUBLET),
    "aileron 1-2-1": ("aileron", _1_2_1),
}
"""Control and steps of each stepped input, by its name."""
MULTISINE = "multisine"
NAMES = (*STEPPED, MULTISINE)
"""Names of all inputs, in the order of a script's table."""

_SHORTEST_AILERON_S = 0.5
"""Shortest step of the aileron, s. A shorter step of a fast roll gives no visible bank."""
_EVEN_S = 0.02
"""Grid of the time units, s. An autopilot renews its outputs every 20 ms or faster."""
_SHORTEST_REST_S = 2.0
"""Shortest hands-off flight after an input, s. Trim and noise are visible after the motion."""
_BAND = (0.2, 2.5)
"""Lowest and highest frequency of a multisine over that of the short period. Below the band, bank and speed
leave the range of the model. The sines reach beyond the corner of the servo: below it, the servo's lag and
the damping act alike. An end at 1.5 gave two to five times wider intervals of M_q on three airframes.
"""
_MULTISINE_S = 20.0
"""Shortest multisine, s. Length of a multisine, s. Three multisines of 20 s on three controls gave 20
derivatives of both axes within 6 %.
"""
_PERIODS = 16.0
"""Least length of a multisine, in short periods. The band then holds seven harmonics for each control."""


@dataclass(frozen=True, slots=True)
class ScriptInput:
    """One input of a script's table."""

    name: str
    held: tuple[Control, ...]
    """Controls that the script holds during the input: those that move, and those whose motion would hide the
    response. Every other control stays with the autopilot."""
    length_s: float
    rest_s: float
    """Hands-off flight after the input, s: two periods of the motion."""
    unit_s: float = 0.0
    """Time unit of a stepped input, s; 0 for a multisine."""
    steps: Steps = ()
    sines: Mapping[Control, Multisine] | None = None

    @property
    def moved(self) -> tuple[Control, ...]:
        return tuple(self.sines) if self.sines is not None else (STEPPED[self.name][0],)


def input_of(name: str, pace: Pace, controls: tuple[Control, ...] = CONTROLS) -> ScriptInput:
    """Return an input for an aircraft with these time constants and controls.

    Parameters
    ----------
    name
        One of ``NAMES``.
    """
    if name == MULTISINE:
        return _multisine(pace, controls)
    control, steps = STEPPED[name]
    unit = _unit_s(control, pace)
    period = pace.period_s if control == "elevator" else pace.dutch_roll_s
    sides = tuple(c for c in controls if (c == "elevator") == (control == "elevator"))
    length = unit * sum(units for units, _ in steps)
    return ScriptInput(name, sides, length, _rest_s(period), unit, steps)


def _multisine(pace: Pace, controls: tuple[Control, ...]) -> ScriptInput:
    """Return a multisine of all controls; the rudder has the lowest harmonics, for the slowest motion."""
    length = float(ceil(max(_MULTISINE_S, _PERIODS * pace.period_s)))
    low, high = (share * length / pace.period_s for share in _BAND)
    order = tuple(c for c in ("rudder", "aileron", "elevator") if c in controls)
    lines = disjoint_harmonics(max(2, round(low)), round(high), len(order))
    sines = {control: multisine(mine) for control, mine in zip(order, lines, strict=True)}
    rest = _rest_s(max(pace.period_s, pace.dutch_roll_s))
    return ScriptInput(MULTISINE, controls, length, rest, sines={c: sines[c] for c in controls})


def _unit_s(control: Control, pace: Pace) -> float:
    """Return the time unit, s: a quarter of a short period, two roll time constants, or half a Dutch roll."""
    wanted, least = {
        "elevator": (0.25 * pace.period_s, SHORTEST_UNIT_S),
        "aileron": (2.0 * pace.roll_s, _SHORTEST_AILERON_S),
        "rudder": (0.5 * pace.dutch_roll_s, SHORTEST_UNIT_S),
    }[control]
    return round(round(max(wanted, least) / _EVEN_S) * _EVEN_S, 2)


def _rest_s(period_s: float) -> float:
    return round(max(_SHORTEST_REST_S, 2.0 * period_s), 1)
