"""Which vehicle is followed: the first, until it is of no use and exactly one other is."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import ManeuverFlown, NoData, Notice, VehicleFound
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.following import FOLLOW, SenderWatch
from tests.flight.columns import Wire, aoa, attitude, fly, heartbeat, hud, plane_parameters, servo, text

START_S = 1000.0


def send(wire, since_s, until_s, rate_hz=10.0, boot_s=50.0, system=1, onsets=()):
    """Streams of an aircraft, heartbeats with them."""
    for k, t in enumerate(np.arange(since_s, until_s, 1.0 / rate_hz).tolist()):
        boot = boot_s + t - since_s
        attitude(wire, t, boot, system=system)
        aoa(wire, t + 1e-4, boot, 2.0, system=system)
        servo(wire, t + 2e-4, boot, {1: 1500, 2: 1500, 3: 1600}, system=system)
        hud(wire, t + 3e-4, system=system)
        if k % int(rate_hz) == 0:
            heartbeat(wire, t + 4e-4, system=system)


def followed(wire, size=None, aircraft=None, **options):
    """Systems followed, one after the other, and what was said."""
    stream = FlightStream(aircraft or Aircraft(), **options)
    size = size or len(wire)
    events = []
    for i in range(0, len(wire), size):
        events += stream.feed(wire.columns(range(i, min(i + size, len(wire)))))
    systems = [event.vehicle.system for event in events if isinstance(event, VehicleFound)]
    return systems, [event.text for event in events if isinstance(event, Notice)], events, stream


def silent_first():
    wire = Wire()
    heartbeat(wire, START_S - 1.0, system=1)
    plane_parameters(wire, START_S - 0.9, system=1)
    send(wire, START_S - 0.5, START_S + 5.0, system=1)
    plane_parameters(wire, START_S + 0.1, system=2)
    send(wire, START_S, START_S + 40.0, system=2)
    fly(wire, START_S + 41.0, 400.0, [4.0], 14.0, system=2)
    return wire


def test_a_vehicle_that_falls_silent_is_left_for_the_only_other_that_has_an_elevator_and_sends():
    systems, said, _, stream = followed(silent_first())
    assert systems == [1, 2]
    assert any("Vehicle 2 is now followed in place of vehicle 1" in s for s in said)
    assert any("--target-system 1" in s for s in said)
    assert stream.vehicle is not None
    assert stream.vehicle.system == 2


def test_the_other_vehicles_manoeuvre_is_found_after_the_change():
    _, _, events, stream = followed(silent_first())
    assert [e.maneuver.number for e in [*events, *stream.finish()] if isinstance(e, ManeuverFlown)] == [1]


@pytest.mark.parametrize("size", [7, 997])
def test_however_messages_are_batched_the_change_comes_at_one_message(size):
    wire = silent_first()
    whole = followed(wire)
    parts = followed(wire, size)
    assert whole[:2] == parts[:2]
    assert whole[3].duration_s == parts[3].duration_s


def test_a_vehicle_without_an_elevator_is_left_for_the_one_that_has_one():
    wire = Wire()
    heartbeat(wire, START_S, kind=2, system=1)
    for k in range(40):
        heartbeat(wire, START_S + k, kind=2, system=1)
    plane_parameters(wire, START_S + 0.1, system=2)
    send(wire, START_S + 0.5, START_S + 30.0, system=2)
    assert followed(wire)[0] == [1, 2]


def test_a_vehicle_asked_for_is_never_left():
    assert followed(silent_first(), target_system=1)[0] == [1]


def test_between_two_others_nobody_chooses_but_the_crew():
    wire = silent_first()
    plane_parameters(wire, START_S + 0.2, system=3)
    send(wire, START_S, START_S + 60.0, system=3)
    assert followed(wire)[0] == [1]


def test_a_vehicle_that_has_served_is_kept_however_long_it_is_silent():
    wire = Wire()
    plane_parameters(wire, START_S - 0.9, system=1)
    end_s = START_S + 70.0  # a minute of service, and more
    send(wire, START_S, end_s, system=1)
    plane_parameters(wire, START_S + 0.1, system=2)
    send(wire, START_S, end_s + 30.0, system=2)
    assert followed(wire)[0] == [1]


def test_the_crews_choice_stands_in_the_stream_and_is_obeyed():
    wire = Wire()
    plane_parameters(wire, START_S - 0.9, system=1)
    plane_parameters(wire, START_S - 0.8, system=2)
    send(wire, START_S, START_S + 10.0, system=1)
    send(wire, START_S, START_S + 10.0, system=2)
    text(wire, START_S + 5.0, (FOLLOW + b"2").decode(), system=254, component=190)
    text(wire, START_S + 6.0, (FOLLOW + b"9").decode(), system=254, component=190)
    assert followed(wire)[0] == [1, 2]


def test_two_vehicles_under_one_id_are_told_within_5_s_with_their_mend():
    wire = Wire()
    fly(wire, START_S, 50.0, [4.0], 20.0)
    send(wire, START_S + 5.0, START_S + 20.0, boot_s=9000.0)
    _, _, events, stream = followed(wire)
    told = [event for event in events if isinstance(event, NoData)]
    assert told[0].problems[0].code == "two_senders"
    assert "system id 1" in told[0].problems[0].text
    assert stream.senders.seen is not None


def test_what_is_wrong_with_the_vehicle_followed_is_told_before_that_others_are_heard():
    wire = Wire()
    plane_parameters(wire, START_S - 0.1, system=1)
    send(wire, START_S, START_S + 10.0, rate_hz=4.0, system=1)
    send(wire, START_S, START_S + 10.0, system=2)
    _, said, events, _ = followed(wire)
    told = [event for event in events if isinstance(event, NoData)]
    assert {problem.code for problem in told[0].problems} == {"rate"}
    assert any("--target-system" in sentence for sentence in said)


def test_a_reboot_and_late_packets_are_no_second_vehicle():
    wire, dice = Wire(), np.random.default_rng(1)
    plane_parameters(wire, START_S - 0.1)
    send(wire, START_S, START_S + 10.0, rate_hz=20.0)
    send(wire, START_S + 12.0, START_S + 30.0, rate_hz=20.0, boot_s=3.0)
    for t in np.arange(START_S + 40.0, START_S + 60.0, 0.05).tolist():
        attitude(wire, t + dice.uniform(0.0, 1.5) * (dice.random() < 0.1), 31.0 + t - START_S)
    assert followed(wire)[3].senders.seen is None


@pytest.mark.parametrize(("component", "is_second"), [(1, True), (154, False)])
def test_a_gimbal_that_sends_its_own_attitude_is_no_second_vehicle(component, is_second):
    wire, watch = Wire(), SenderWatch()
    for k in range(100):
        attitude(wire, START_S + 0.1 * k, 50.0 + 0.1 * k)
        attitude(wire, START_S + 0.1 * k + 0.05, 9000.0 + 0.1 * k, component=component)
    for number in range(len(wire)):
        watch.hear(wire.columns([number]), 1)
    assert (watch.problem(1, START_S + 10.0) is not None) == is_second
