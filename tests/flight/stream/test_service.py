"""NO DATA: what arrives at present is judged, at any time of the flight, and told once."""

from itertools import pairwise

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import DataAgain, ManeuverFlown, NoData
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.flight.stream.suitability import Service
from advisor.words.problems import Problem
from tests.flight.columns import Wire, aoa, attitude, fly, heartbeat, hud, plane_parameters, servo

START_S = 1000.0
SOON_S = 5.0


def told(wire, size=40):
    """(arrival of the messages that brought it, event) of NoData and DataAgain, some messages at a time."""
    stream = FlightStream(Aircraft())
    found = []
    for i in range(0, len(wire), size):
        columns = wire.columns(range(i, min(i + size, len(wire))))
        now_s = max(float(c.arrival_s[-1]) for c in columns)
        found += [(now_s, event) for event in stream.feed(columns) if isinstance(event, NoData | DataAgain)]
    return found


def send(wire, since_s, until_s, rate_hz, boot_s=50.0):
    for t in np.arange(since_s, until_s, 1.0 / rate_hz).tolist():
        boot = boot_s + t - START_S
        attitude(wire, t, boot)
        aoa(wire, t + 1e-4, boot, 2.0)
        servo(wire, t + 2e-4, boot, {1: 1500, 2: 1500, 3: 1600, 4: 1500})
        hud(wire, t + 3e-4)
    for t in np.arange(since_s, until_s, 1.0).tolist():
        heartbeat(wire, t + 4e-4)


@pytest.fixture(scope="module")
def slow_for_twenty_seconds():
    """A flight that is slow for 20 s after its manoeuvre, and what was told of it."""
    wire = Wire()
    fly(wire, START_S, 50.0, [4.0], 20.0)
    send(wire, START_S + 20.1, START_S + 40.0, 4.0)
    send(wire, START_S + 40.0, START_S + 60.0, 50.0)
    return wire, told(wire)


def test_a_link_that_serves_is_never_told_of():
    wire = Wire()
    fly(wire, START_S, 50.0, [4.0], 30.0)
    assert told(wire) == []


def test_a_slow_link_without_parameters_is_told_within_5_s_with_all_that_is_wrong():
    wire = Wire()
    heartbeat(wire, START_S)
    send(wire, START_S, START_S + 20.0, 4.0)
    ((at_s, event),) = told(wire)
    assert at_s - START_S < SOON_S
    assert [problem.code for problem in event.problems] == ["no_elevator", "rate", "rate"]
    assert all(problem.fix for problem in event.problems)


def test_a_link_that_becomes_slow_after_a_manoeuvre_is_told_within_5_s_and_told_once_when_it_serves_again(
    slow_for_twenty_seconds,
):
    wire, ((slow_s, slow), (again_s, again)) = slow_for_twenty_seconds
    assert isinstance(slow, NoData)
    assert slow_s - (START_S + 20.0) < SOON_S
    assert {problem.code for problem in slow.problems} == {"rate"}
    assert isinstance(again, DataAgain)
    assert again_s > START_S + 40.0
    stream = FlightStream(Aircraft())
    assert any(isinstance(event, ManeuverFlown) for event in stream.feed(wire.columns()))
    assert stream.service.problems == ()


def test_a_message_that_stops_is_told_though_the_vehicles_clock_stands_still():
    wire = Wire()
    fly(wire, START_S, 50.0, [], 10.0)
    for t in np.arange(START_S + 10.0, START_S + 20.0, 0.1).tolist():
        heartbeat(wire, t)
    ((at_s, event),) = told(wire, 10)  # a heartbeat each tenth of a second
    assert at_s - (START_S + 10.0) < SOON_S
    assert event.problems[0].code in ("no_pitch_rate", "no_elevator")
    assert "no_pitch_rate" in {problem.code for problem in event.problems}


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.study) for n in (1, 2))])
def test_a_rate_about_its_limit_is_not_told_in_turns(seed):
    wire, dice, t = Wire(), np.random.default_rng(seed), START_S
    heartbeat(wire, t)
    plane_parameters(wire, t + 1e-3)
    while t < START_S + 120.0:
        send(wire, t, t + 0.99, 8.0 + dice.uniform(-2.0, 2.0))
        t += 1.0
    times = [at_s for at_s, _ in told(wire)]
    assert all(later - earlier >= 5.0 for earlier, later in pairwise(times[::2]))


def test_one_second_of_loss_is_not_told():
    wire = Wire()
    fly(wire, START_S, 50.0, [], 10.0)
    heartbeat(wire, START_S + 10.5)
    send(wire, START_S + 11.0, START_S + 20.0, 50.0)
    assert told(wire) == []


def test_a_silence_of_the_link_is_the_links_to_tell():
    wire = Wire()
    fly(wire, START_S, 50.0, [], 10.0)
    send(wire, START_S + 60.0, START_S + 70.0, 50.0)
    assert told(wire) == []


def test_a_ground_station_alone_is_no_vehicle_and_said_so():
    wire = Wire()
    for k in range(10):
        heartbeat(wire, START_S + k, autopilot=8, kind=6, system=255)
    ((at_s, event),) = told(wire, 1)
    assert at_s - START_S <= SOON_S
    assert [problem.code for problem in event.problems] == ["no_vehicle"]


@pytest.mark.parametrize(("over_ground", "codes"), [(0.2, []), (20.0, ["no_alpha"])])
def test_an_angle_that_only_flight_can_give_is_missed_in_flight_alone(over_ground, codes):
    wire = Wire()
    heartbeat(wire, START_S)
    plane_parameters(wire, START_S + 1e-3)
    for k in range(500):
        t = k / 50
        attitude(wire, START_S + t, 50.0 + t)
        servo(wire, START_S + t + 1e-4, 50.0 + t, {1: 1500, 2: 1500})
        wire.send(
            "VFR_HUD",
            START_S + t + 2e-4,
            airspeed=0.5,
            groundspeed=over_ground,
            throttle=0,
            alt=0.0,
            climb=0.0,
        )
    found = [problem.code for _, event in told(wire) for problem in event.problems]
    assert found == codes


def test_a_log_tells_the_same_as_a_link_however_its_messages_are_batched(slow_for_twenty_seconds):
    wire, by_message = slow_for_twenty_seconds
    live = [event for _, event in by_message]
    for size in (21, 501, len(wire)):
        assert [event for _, event in told(wire, size)] == live


def test_the_vehicles_time_of_what_is_told_is_its_newest_and_old_readings_are_forgotten():
    late = Problem("rate", "ATTITUDE arrives too slowly.", "Raise its rate.")
    service = Service(lambda channels, now_s: [late] if now_s > 600.0 else [])
    arrival_s = np.arange(0.0, 620.0, 0.25)
    service.take_clock(arrival_s, arrival_s + 70.0)
    service.take("q", "ATTITUDE", arrival_s)
    columns = Columns("ATTITUDE", 1, 1, np.arange(len(arrival_s)), arrival_s, {})
    (event,) = service.advance([columns])
    assert 671.0 < event.at_s < 673.0
    assert len(service._clock) < 20, "readings of the last seconds alone are kept"
