"""Published tolerances of roll and yaw: 14 CFR Part 60, Appendix A, Table A2A, tests 2.d.2 and 2.d.7.

Roll response (2.d.2): roll rate within 10 % or 2 °/s. Dutch roll (2.d.7): period within 10 %, and time to
half amplitude within 10 % or damping ratio within 0.02. The table's alternative of 0.5 s for the period is a
quarter of a small aircraft's period. The 0.5 s limit and the time between peaks of bank and sideslip are not
applied.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, inf, isfinite, log, pi

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix

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
    b = aileron_rad * np.array([value["Y_delta_a"], value["L_delta_a"], value["N_delta_a"], 0.0])
    # The input as a fifth state that stands still: one matrix gives state and response.
    held = np.zeros((5, 5))
    held[:4, :4], held[:4, 4] = a, b
    dt = step_s / _STEPS
    # Taylor's series of four terms has an error of (|A|·dt)⁵, far below the tolerance.
    power, turned = np.eye(5), np.eye(5)
    for k in range(1, 5):
        power = power @ held * (dt / k)
        turned = turned + power
    x, largest = np.array([0.0, 0.0, 0.0, 0.0, 1.0]), 0.0
    for _ in range(_STEPS):
        x = turned @ x
        largest = x[1] if abs(x[1]) > abs(largest) else largest
    return float(largest)
