import numpy as np
import pytest

from sim.flight import Flight
from sim.lateral import FULL_RAD, PLAN, UAV, LateralAircraft, lateral_flight
from sim.linear import RESEARCH_JET
from sim.motion import Controls
from sim.scenario import Scenario


@pytest.fixture
def aircraft():
    return LateralAircraft(RESEARCH_JET, 25.0, 150.0, UAV)


def flown(aircraft, seconds, aileron=0.0, rudder=0.0, dt=0.002):
    level = aircraft.trim
    for _ in range(round(seconds / dt)):
        motion = aircraft.step(Controls(level.elevator, level.throttle, aileron, rudder=rudder), dt)
    return motion


def test_an_aileron_to_the_right_rolls_to_the_right_at_the_rate_of_the_roll_mode(aircraft):
    rate = flown(aircraft, 0.25, aileron=0.2).p
    steady = UAV["L_delta_a"] * -FULL_RAD * 0.2 / -UAV["L_p"]
    assert rate == pytest.approx(steady * (1.0 - np.exp(0.25 * UAV["L_p"])), rel=0.1)


def test_a_rudder_to_the_right_yaws_to_the_right(aircraft):
    assert flown(aircraft, 0.2, rudder=0.3).r > 0.05


def test_hands_off_a_kick_leaves_the_dutch_roll(aircraft):
    flown(aircraft, 0.4, rudder=0.5)
    rates = [flown(aircraft, 0.02).r for _ in range(250)]
    swing = np.array(rates[25:]) - np.mean(rates[125:])
    turns = np.flatnonzero(np.diff(np.signbit(swing)))
    period_s = 2.0 * 0.02 * np.median(np.diff(turns))
    assert 2.0 * np.pi / period_s == pytest.approx(3.56, rel=0.1)


def test_the_plan_is_flown_in_manual_with_a_still_elevator():
    times = {"lead_in_s": 1.0, "settling_s": 0.5, "free_s": 0.5, "gap_s": 0.5, "closing_s": 0.5}
    flight = lateral_flight(Scenario(step_s=0.0025, loop_hz=25.0, **times), noisy=False)
    assert isinstance(flight, Flight)
    samples = list(flight.samples())
    flying = {s.flying.start_s for s in samples if s.flying is not None}
    assert len(flying) == len(PLAN)
    assert len({s.pulse_us for s in samples}) == 1
    assert {s.mode for s in samples if s.flying is not None} == {0}
