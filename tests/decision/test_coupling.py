"""An influence that the model lacks and that moves an estimate out of its interval refuses the manoeuvre."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.axes.influences import PITCH, LinearMotion, bias_by, coupled
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.oem.estimator import estimate
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.solution import Solution, solve

DEG = np.radians(1.0)
STEP_S = 0.02
T = np.arange(0.0, 14.0, STEP_S)
STEPS = ((2.0, -1.5), (3.5, 1.5), (4.5, -1.5), (5.0, 1.5), (5.5, 0.0))
M_Q = -2.0


def flown(size=1.0, moment=None, **others):
    """(manoeuvre, estimate) of a 3-2-1-1 in which an unknown moment, rad/s², acts besides the elevator."""
    rng = np.random.default_rng(7)
    elevator = np.zeros(len(T))
    for onset, level in STEPS:
        elevator[onset <= T] = size * level * DEG
    alpha, q = np.zeros(len(T)), np.zeros(len(T))
    acts = np.zeros(len(T)) if moment is None else moment
    for i in range(1, len(T)):
        alpha[i] = alpha[i - 1] + STEP_S * (-1.0 * alpha[i - 1] + q[i - 1])
        moments = -6.0 * alpha[i - 1] + M_Q * q[i - 1] - 10.0 * elevator[i - 1] + acts[i - 1]
        q[i] = q[i - 1] + STEP_S * moments
    noise = 0.02 * DEG * rng.standard_normal((2, len(T)))
    values = {"elevator": elevator, "alpha": alpha + noise[0], "q": q + noise[1], **others}
    channels = {name: Channel(name, T, y) for name, y in values.items()}
    steps = tuple((onset, size * level * DEG) for onset, level in STEPS)
    maneuver = Maneuver(1, 0, Span(0.0, 2.0, 5.5, 13.98, "3-2-1-1", steps, "quiet"), channels, "MANUAL")
    return maneuver, estimate(maneuver, Aircraft(elevator=Elevator(lag_s=0.0)))


def dutch_roll(size):
    """Roll and yaw rate, rad/s, of an oscillation at 2 rad/s with this amplitude of the roll rate."""
    return size * np.sin(2.0 * T), -0.4 * size * np.sin(2.0 * T)


def test_rolling_with_yawing_that_moves_the_damping_is_named():
    p, r = dutch_roll(25.0 * DEG)
    maneuver, estimated = flown(0.15, 0.8 * p * r, p=p, r=r)
    (reason,) = coupled(maneuver, estimated)
    assert reason.code == "coupling"
    assert reason.value > reason.limit == 1.0
    assert "let roll and yaw die down" in reason.text


def test_a_gentle_dutch_roll_during_a_large_input_is_lived_with():
    p, r = dutch_roll(2.0 * DEG)
    assert coupled(*flown(1.0, 0.8 * p * r, p=p, r=r)) == []


def test_a_throttle_whose_moment_moves_an_estimate_is_named_even_where_it_moved_little():
    throttle = 0.5 + 0.1 * np.clip((T - 2.0) / 2.0, 0.0, 1.0)
    reason, *_ = coupled(*flown(0.3, 0.3 * (throttle - 0.5), throttle=throttle))
    assert reason.code == "throttle"
    assert "leave the throttle where it is" in reason.text


def test_a_throttle_without_a_pitching_moment_is_lived_with():
    throttle = 0.5 + 0.1 * np.clip((T - 2.0) / 2.0, 0.0, 1.0)
    assert coupled(*flown(0.3, throttle=throttle)) == []


def test_the_bias_of_a_known_moment_is_the_error_of_the_estimate_within_a_factor_of_two():
    p, r = dutch_roll(18.0 * DEG)
    maneuver, estimated = flown(0.5, 0.8 * p * r, p=p, r=r)
    bias = of_moment(maneuver, estimated, p * r)
    assert bias is not None
    off = derivatives(maneuver) - derivatives(flown(0.5)[0])
    for name in ("M_alpha", "M_delta_e"):
        k = PARAMETERS.index(name)
        assert 0.5 < 0.8 * bias.of_one[k] / off[k] < 2.0


def of_moment(maneuver, estimated, moment):
    """Return the bias by an omitted pitching moment, rad/s²."""
    linear = LinearMotion(PITCH, maneuver, estimated, estimated.fits[0]["q"].t)
    return bias_by(np.interp(linear.t, T, moment), "q", linear, estimated)


def derivatives(maneuver):
    """Return the parameters of a manoeuvre, without any of its instruments."""
    prepared = prepare([maneuver], Aircraft(elevator=Elevator(lag_s=0.0)))
    assert isinstance(prepared, Prepared)
    found = solve(prepared.problem)
    assert isinstance(found, Solution)
    return found.theta


def test_a_record_without_roll_and_yaw_rate_is_not_asked():
    maneuver, estimated = flown()
    assert coupled(maneuver, estimated) == []
    assert of_moment(maneuver, estimated, np.ones(len(T))) is None


def test_a_model_so_unstable_that_its_response_overflows_tells_no_bias():
    p, r = dutch_roll(25.0 * DEG)
    maneuver, estimated = flown(p=p, r=r)
    theta = estimated.theta.copy()
    theta[PARAMETERS.index("M_alpha")] = 1e6
    assert coupled(maneuver, replace(estimated, theta=theta)) == []


def test_an_aileron_with_a_pitching_moment_that_moves_an_estimate_is_named():
    aileron = 6.0 * DEG * np.sin(2.2 * T)
    maneuver, estimated = flown(0.3, 1.0 * aileron, aileron=aileron)
    assert [reason.code for reason in coupled(maneuver, estimated, {"aileron"})] == ["aileron"]
    assert coupled(*flown(0.3, aileron=aileron), {"aileron"}) == []
