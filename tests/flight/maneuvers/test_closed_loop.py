"""A test input through an autopilot's pitch loop: found by its steps, and fitted as well as in MANUAL."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.purpose import not_an_input
from advisor.flight.signals.record import Channel
from advisor.oem.estimator import estimate

DEG = np.radians(1.0)
STEP_S = 0.02
T = np.arange(0.0, 12.0, STEP_S)
STEPS = ((2.0, -2.0), (3.5, 2.0), (4.5, -2.0), (5.0, 2.0), (5.5, 0.0))
TRUE = {"M_alpha": -6.0, "M_q": -2.0, "M_delta_e": -10.0}


def flown(mode, rate_gain, angle_gain):
    """A 3-2-1-1 of the demand on top of a loop that feeds pitch rate and pitch angle back to the elevator."""
    rng = np.random.default_rng(4)
    demand = np.zeros(len(T))
    for onset, level in STEPS:
        demand[onset <= T] = level * DEG
    elevator, alpha, q, theta = demand, np.zeros(len(T)), np.zeros(len(T)), np.zeros(len(T))
    for i in range(1, len(T)):
        elevator[i - 1] += rate_gain * q[i - 1] + angle_gain * theta[i - 1]
        alpha[i] = alpha[i - 1] + STEP_S * (-1.5 * alpha[i - 1] + q[i - 1])
        moment = TRUE["M_alpha"] * alpha[i - 1] + TRUE["M_q"] * q[i - 1] + TRUE["M_delta_e"] * elevator[i - 1]
        q[i] = q[i - 1] + STEP_S * moment
        theta[i] = theta[i - 1] + STEP_S * q[i - 1]
    noise = 0.05 * DEG * rng.standard_normal((2, len(T)))
    values = {"elevator": elevator, "alpha": alpha + noise[0], "q": q + noise[1], "theta": theta}
    channels = {name: Channel(name, T, y) for name, y in values.items()}
    shape = tuple((onset, level * DEG) for onset, level in STEPS)
    return Maneuver(1, 0, Span(1.0, 2.0, 5.5, 11.9, "3-2-1-1", shape, "quiet"), channels, mode)


@pytest.mark.parametrize("mode", ["STABILIZE", "FBWA", "FBWB", "CRUISE"])
@pytest.mark.parametrize("gains", [(0.1, 0.2), (0.2, 0.6)])
def test_a_test_in_a_closed_loop_is_found_and_its_derivatives_are_right(mode, gains):
    maneuver = flown(mode, *gains)
    assert not_an_input(maneuver) is None
    fitted = estimate(maneuver, Aircraft())
    for name, true in TRUE.items():
        assert fitted.value(name) == pytest.approx(true, rel=0.08)
