import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem.estimator import estimate
from tests.oem.builders import UAV, maneuver, simulate, trim_alpha, trim_elevator

PERIOD = 0.02


def smooth_flight(early_s, held, seed=1):
    """Return a manoeuvre of the small aircraft whose smooth command acts ``early_s`` before its stamps."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, PERIOD)
    u = trim_elevator(UAV) + 0.01 * (np.sin(3.0 * t) + np.sin(7.0 * t) + np.sin(11.0 * t))
    fine = np.arange(0.0, 8.0 - 2.0 * PERIOD, 0.001)
    acting = fine + early_s
    command = u[np.searchsorted(t, acting + 1e-9, side="right") - 1] if held else np.interp(acting, t, u)
    stamps = t[1:-3] + 0.007
    x = simulate(UAV, [trim_alpha(UAV), 0.0], fine, command, stamps)
    noise = 0.01 * x[:, :2].std(axis=0) * rng.standard_normal((len(x), 2))
    channels = {"alpha": (stamps, x[:, 0] + noise[:, 0]), "q": (stamps, x[:, 1] + noise[:, 1])}
    return maneuver(1, (t, u), channels)


@pytest.mark.parametrize(("early_s", "held"), [(0.005, True), (0.014, True), (-0.006, False), (0.006, False)])
def test_a_smooth_command_recorded_early_or_late_does_not_pass_for_other_derivatives(early_s, held):
    found = estimate(smooth_flight(early_s, held), Aircraft(elevator=Elevator(lag_s=0.0)))
    assert np.all(np.abs(found.theta - UAV) < 3.5 * found.std)
    assert any("acts" in note for note in found.notes)


def test_a_command_on_time_gets_no_offset():
    found = estimate(smooth_flight(0.0, False), Aircraft(elevator=Elevator(lag_s=0.0)))
    assert not any("acts" in note for note in found.notes)


def test_an_unknown_servo_gets_no_offset_for_a_lag_would_pass_for_one():
    found = estimate(smooth_flight(0.006, False), Aircraft())
    assert not any("acts" in note for note in found.notes)
