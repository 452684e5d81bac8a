import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.oem.estimator import estimate
from advisor.oem.identifiability import natural_size
from advisor.report.document import identifiability
from tests.oem.builders import JET, UAV, elevator_3211, flown, maneuver, trim_alpha, trim_elevator

AIRCRAFT = Aircraft(elevator=Elevator(lag_s=0.0))


def so_far(maneuver, until_s):
    channels = {name: channel.cut(-1.0, until_s) for name, channel in maneuver.channels.items()}
    return Maneuver(1, maneuver.boot, maneuver.span, channels, maneuver.mode)


def test_errors_shrink_as_a_manoeuvre_grows():
    flight = flown(JET, noise=0.03)
    early, late = (estimate(so_far(flight, until), AIRCRAFT) for until in (6.0, 12.0))
    assert np.all(late.std_cr < early.std_cr)


@pytest.fixture(scope="module")
def sluggish():
    """Return the estimates of an overdamped aircraft with an unknown and with a known servo."""
    theta = np.array([0.05, -12.0, 0.0, 0.5, 0.3, -20.0, -25.0, -100.0])
    flight = flown(theta, unit_s=0.4, noise=0.05, length_s=9.0)
    return estimate(flight, Aircraft()), estimate(flight, AIRCRAFT)


def test_the_lag_of_an_overdamped_aircraft_s_unknown_servo_is_told_by_the_record(sluggish):
    for found in sluggish:
        assert abs(found.value("M_alpha") + 20.0) < 2.0 * found.std[5]
        assert abs(found.value("M_delta_e") + 100.0) < 2.0 * found.std[7]


def looped(theta, pilot, seed=0):
    """Simulate, by Runge-Kutta, an elevator that feeds back α and q without delay, and a pilot's input."""
    h = 0.001
    t = np.arange(0.0, 10.0, h)
    # The stick moves midway between two samples of the command.
    stick = pilot * elevator_3211(t, trim=0.0, amplitude=0.03, unit_s=0.5, begin_s=1.01)
    trim = np.array([trim_alpha(theta), 0.0])
    a = np.array([[theta[1], 1.0 + theta[2]], [theta[5], theta[6]]])
    closed = a + np.outer(theta[[3, 7]], LOOP)
    x = np.zeros((len(t), 2))
    x[0] = 0.03, 0.05
    for k in range(len(t) - 1):
        now, middle, then = stick[k], (stick[k] + stick[k + 1]) / 2.0, stick[k + 1]
        k1 = closed @ x[k] + theta[[3, 7]] * now
        k2 = closed @ (x[k] + h / 2.0 * k1) + theta[[3, 7]] * middle
        k3 = closed @ (x[k] + h / 2.0 * k2) + theta[[3, 7]] * middle
        k4 = closed @ (x[k] + h * k3) + theta[[3, 7]] * then
        x[k + 1] = x[k] + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    u = trim_elevator(theta) + x @ LOOP + stick
    rng = np.random.default_rng(seed)
    t, u, z = t[::20], u[::20], (x + trim)[::20]
    z = z + 0.02 * z.std(axis=0) * rng.standard_normal(z.shape)
    return maneuver(1, (t, u), {"alpha": (t, z[:, 0]), "q": (t, z[:, 1])})


LOOP = np.array([0.3, 0.05])


@pytest.mark.parametrize("servo", [Elevator(lag_s=0.0), Elevator()])
@pytest.mark.parametrize("seed", range(2))
def test_an_elevator_that_only_follows_the_motion_gives_no_numbers_however_good_the_fit(servo, seed):
    found = estimate(looped(UAV, pilot=0.0, seed=seed), Aircraft(elevator=servo))
    if isinstance(found, NoEstimate):
        assert "equally well" in found.text
        return
    assert min(fit.r2 for fit in found.fits[0].values()) > 0.99
    assert {"Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e"} <= set(found.not_identifiable)
    assert "closed loop" in found.not_identifiable["M_delta_e"]


def test_a_pilot_s_own_motion_in_a_closed_loop_identifies_the_aircraft_behind_it():
    found = estimate(looped(UAV, pilot=1.0), AIRCRAFT)
    assert not found.not_identifiable
    assert found.value("M_alpha") == pytest.approx(UAV[5], rel=0.1)


def test_control_derivatives_are_lost_when_only_the_free_motion_stands_out_of_the_noise():
    weak = estimate(flown(JET, amplitude=1e-4, noise=3.0), AIRCRAFT)
    assert {"Z_delta_e", "M_delta_e"} <= set(weak.not_identifiable)
    assert "M_q" not in weak.not_identifiable
    half = 1.96 * weak.std[PARAMETERS.index("M_delta_e")]
    assert f"its error ±{half:.3g} is" in weak.not_identifiable["M_delta_e"]


def test_natural_sizes_follow_the_poles_and_the_control_power():
    sizes = natural_size(UAV)
    assert sizes["M_alpha"] == pytest.approx(8.0 * 4.2 + 0.97 * 48.0)
    assert sizes["M_delta_e"] == 102.0


def test_correlated_errors_are_named_in_words_and_in_the_document():
    found = estimate(flown(UAV, unit_s=0.4, noise=0.02), AIRCRAFT)
    assert ("M_q", "M_delta_e") in [pair[:2] for pair in found.correlated]
    assert any("correlated above 0.9" in note and "M_q and M_δe" in note for note in found.notes)
    document = identifiability(found)
    assert document["condition"] > 1.0
    (told,) = (x for x in document["correlated"] if x["parameters"] == ["M_q", "M_delta_e"])
    assert 0.9 < told["correlation"] < 1.0


def test_errors_that_are_not_correlated_need_no_words():
    found = estimate(flown(JET, amplitude=0.1, noise=0.02), AIRCRAFT)
    assert found.correlated == ()
    assert not any("correlated" in note for note in found.notes)
