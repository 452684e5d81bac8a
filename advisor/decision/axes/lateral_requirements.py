"""Published requirements of roll and yaw: levels of flying qualities, and tolerances of a simulator.

MIL-F-8785C, *Flying Qualities of Piloted Airplanes* (5 November 1980). Paragraph 3.3.1.1 (Table VI) sets
lower limits of frequency ω, damping ζ and ζ·ω of the Dutch roll. Paragraph 3.3.1.2 (Table VII) sets an upper
limit of the roll mode's time constant. Paragraph 3.3.1.3 (Table VIII) sets a lower limit of the time in which
the spiral doubles the bank. Not included are ζ of 0.4 for air combat and ground attack, and the larger ζ·ω if
ω²·|φ/β| exceeds 20 rad²/s².

14 CFR Part 60, Appendix A, Table A2A. Roll response (2.d.2): roll rate within 10 % or 2 °/s. Dutch roll
(2.d.7): period within 10 %, and time to half amplitude within 10 % or damping ratio within 0.02. The table's
alternative of 0.5 s for the period is a quarter of a small aircraft's period. The 0.5 s limit and the time
between peaks of bank and sideslip are not applied.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, inf, isfinite, log, pi
from typing import Literal

import numpy as np

from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.model.mil_f_8785c import CATEGORIES, Category, LevelFound, Measured, Range, assess
from advisor.oem.flying_qualities import Quality
from advisor.process.arrays import FloatArray

SOURCE = "MIL-F-8785C, paragraphs 3.3.1.1 to 3.3.1.3"
Group = Literal["I, II-C, IV", "II-L, III"]
GROUPS: Mapping[Group, str] = {
    "I, II-C, IV": "light or highly manoeuvrable aircraft",
    "II-L, III": "medium and heavy aircraft",
}
"""Aircraft of each group of classes with equal requirements. Category A treats all of Class II as II-L."""
Mode = Literal["dutch_roll", "roll", "spiral"]
_DUTCH: Mapping[Group, Mapping[Category, tuple[float, ...]]] = {
    "I, II-C, IV": {"A": (0.19, 0.35, 1.0), "B": (0.08, 0.15, 0.4), "C": (0.08, 0.15, 1.0)},
    "II-L, III": {"A": (0.19, 0.35, 0.4), "B": (0.08, 0.15, 0.4), "C": (0.08, 0.10, 0.4)},
}
"""Level 1 of the Dutch roll: least ζ, ζ·ω in rad/s, and ω in rad/s."""
_DUTCH_BELOW = ((0.02, 0.05, 0.4), (0.0, -inf, 0.4))
"""Levels 2 and 3 of the Dutch roll, equal for every class and category."""
_ROLL: Mapping[Group, Mapping[Category, tuple[float, ...]]] = {
    "I, II-C, IV": {"A": (1.0, 1.4, 10.0), "B": (1.4, 3.0, 10.0), "C": (1.0, 1.4, 10.0)},
    "II-L, III": dict.fromkeys(CATEGORIES, (1.4, 3.0, 10.0)),
}
"""Largest time constant of the roll mode in levels 1 to 3, s."""
_SPIRAL: Mapping[Category, tuple[float, ...]] = {
    "A": (12.0, 8.0, 4.0), "B": (20.0, 8.0, 4.0), "C": (12.0, 8.0, 4.0),
}  # fmt: skip
"""Least time to double the bank in levels 1 to 3, s."""


@dataclass(frozen=True, slots=True)
class LateralLevels:
    """Levels of the lateral modes for one group of classes in one category of flight phases."""

    group: Group
    category: Category
    by_mode: Mapping[Mode, LevelFound]
    """Level of every mode in the estimate, by the mode's name."""

    @property
    def governing(self) -> LevelFound:
        levels = self.by_mode.values()
        return LevelFound(
            self.category,
            max(level.level for level in levels),
            max(level.best_level for level in levels),
            max(level.worst_level for level in levels),
        )


def lateral_levels(modes: Mapping[str, Quality]) -> tuple[LateralLevels, ...]:
    """Return the levels by group of classes and category; empty for an estimate without modes.

    The interval of ζ·ω is the product of both intervals' ends, which is wider than 95 %.
    """
    values = _values(modes)
    if not values:
        return ()
    return tuple(
        LateralLevels(
            group,
            category,
            {mode: assess(category, _limits(mode, group, category), values[mode]) for mode in values},
        )
        for group in GROUPS
        for category in CATEGORIES
    )


def _values(modes: Mapping[str, Quality]) -> dict[Mode, list[Measured]]:
    """Return the parameters of each mode in the order of its limits."""
    values: dict[Mode, list[Measured]] = {}
    zeta, omega = modes.get("dutch_roll_zeta"), modes.get("dutch_roll_omega")
    if zeta is not None and omega is not None:
        (low, high), (slow, fast) = zeta.ci95, omega.ci95
        product = zeta.value * omega.value, (low * slow, high * fast)
        values["dutch_roll"] = [(zeta.value, zeta.ci95), product, (omega.value, omega.ci95)]
    if (roll := modes.get("roll_time_constant")) is not None:
        values["roll"] = [(roll.value, roll.ci95)]
    if (spiral := modes.get("spiral_pole")) is not None:
        values["spiral"] = [(spiral.value, spiral.ci95)]
    return values


def _limits(mode: Mode, group: Group, category: Category) -> list[list[Range]]:
    if mode == "dutch_roll":
        levels = _DUTCH[group][category], *_DUTCH_BELOW
        return [[(least, inf) for least in level] for level in levels]
    if mode == "roll":
        return [[(-inf, longest)] for longest in _ROLL[group][category]]
    return [[(-inf, log(2.0) / doubled)] for doubled in _SPIRAL[category]]


SHARE = 0.10
"""Largest error of roll rate, period and time to half amplitude, relative to the flown value."""
RATE_DEG_S = 2.0
"""Largest error of the roll rate, deg/s, if larger than ``SHARE`` of the flown roll rate."""
DAMPING = 0.02
"""Largest error of the damping ratio, if the time to half amplitude is not within ``SHARE``."""
_STEPS = 200
"""Number of instants at which the roll rates are compared."""


@dataclass(frozen=True, slots=True)
class LateralTest:
    """One test of the table, with the values of the aircraft and of the simulator."""

    entry: str
    """Number of the test in Table A2A."""
    name: str
    unit: str
    flown: float
    simulated: float
    limit: float
    """Largest allowed difference between aircraft and simulator, in ``unit``."""

    @property
    def holds(self) -> bool:
        """Whether the difference is within the limit of the table."""
        return abs(self.simulated - self.flown) <= self.limit


def lateral_qualification(
    flown: FloatArray, simulated: FloatArray, trim: Trim, aileron_rad: float, step_s: float
) -> tuple[LateralTest, ...]:
    """Return the qualification tests of a simulator's derivatives against the estimated ones.

    Parameters
    ----------
    flown, simulated
        Shape (15,): derivatives in the order of ``LATERAL``.
    aileron_rad, step_s
        Size and duration of the aileron step for the roll response.
    """
    a_flown, a_simulated = state_matrix(flown, trim), state_matrix(simulated, trim)
    rates = [
        degrees(peak_roll_rate(theta, a, aileron_rad, step_s))
        for theta, a in ((flown, a_flown), (simulated, a_simulated))
    ]
    limit = max(SHARE * abs(rates[0]), RATE_DEG_S)
    roll = LateralTest("2.d.2", "peak roll rate", "deg/s", rates[0], rates[1], limit)
    dutch = [modes_of(a).dutch_roll for a in (a_flown, a_simulated)]
    if dutch[0] is None or dutch[1] is None:
        return (roll,)
    return (roll, *dutch_roll_tests(dutch[0], dutch[1]))


def dutch_roll_tests(flown: complex, simulated: complex) -> tuple[LateralTest, LateralTest]:
    """Return the tests of period and damping for two Dutch rolls, given by their eigenvalues.

    The damping is compared by the measure with the larger allowed difference.
    """
    period_s, half_s, damping = (
        [measure(value) for value in (flown, simulated)] for measure in (_period_s, _half_s, _damping)
    )
    period = LateralTest("2.d.7", "Dutch roll period", "s", period_s[0], period_s[1], SHARE * period_s[0])
    half = LateralTest("2.d.7", "time to half amplitude", "s", half_s[0], half_s[1], SHARE * abs(half_s[0]))
    ratio = LateralTest("2.d.7", "Dutch roll damping", "", damping[0], damping[1], DAMPING)
    by_time = isfinite(half_s[0]) and half.holds and not ratio.holds
    return period, half if by_time else ratio


def _period_s(value: complex) -> float:
    return 2.0 * pi / value.imag


def _half_s(value: complex) -> float:
    """Return the time to half amplitude, s; negative for a growing oscillation."""
    return -log(2.0) / value.real if value.real else inf


def _damping(value: complex) -> float:
    return -value.real / abs(value)


def peak_roll_rate(theta: FloatArray, a: FloatArray, aileron_rad: float, step_s: float) -> float:
    """Return the largest roll rate within a step of the aileron, rad/s, from straight flight.

    Parameters
    ----------
    theta
        Shape (15,): lateral derivatives.
    a
        Shape (4, 4): state matrix of these derivatives.
    """
    value: Mapping[str, float] = dict(zip(LATERAL.names.reported, theta.tolist(), strict=True))
    b = np.array([value["Y_delta_a"], value["L_delta_a"], value["N_delta_a"], 0.0])
    from scipy.signal import lsim  # not on the start path

    t, roll_rate = np.linspace(0.0, step_s, _STEPS + 1), np.eye(4)[[1]]
    p = lsim((a, b[:, None], roll_rate, np.zeros((1, 1))), np.full(_STEPS + 1, aileron_rad), t, interp=False)[
        1
    ]
    return float(p[np.argmax(np.abs(p))])
