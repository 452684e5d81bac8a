"""On the ground, in take-off and after a crash nothing is estimated."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Activity
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, aoa, attitude, plane_parameters, pull, servo
from tests.heard import hear
from tests.rows import row

START_S = 1000.0


def movement(speed=20.0, over_ground=20.0, height=80.0, armed=True, landed=None, answer=0.2):
    """A 3-2-1-1 at 4 s in a record of 14 s; speeds may be functions of the time.

    The pitch rate answers with ``answer`` rad/s; ``landed`` is MAV_LANDED_STATE.
    """
    wire = Wire()
    plane_parameters(wire, START_S - 0.5)
    for k in range(14 * 50):
        t = k / 50
        now, boot, sense = START_S + t, 50.0 + t, pull(t - 4.0)
        v = speed(t) if callable(speed) else speed
        if k % 50 == 0:
            wire.send(
                "HEARTBEAT", now - 1e-3, type=1, autopilot=3, custom_mode=0, base_mode=217 if armed else 89
            )
            wire.send(
                "GLOBAL_POSITION_INT", now, time_boot_ms=round(boot * 1e3), relative_alt=round(1e3 * height)
            )
            if landed is not None:
                wire.send("EXTENDED_SYS_STATE", now + 1e-5, vtol_state=0, landed_state=landed)
        attitude(wire, now + 1e-4, boot, q=answer * sense)
        aoa(wire, now + 2e-4, boot, 2.0 + sense)
        servo(wire, now + 3e-4, boot, {1: 1500, 2: 1500 + 20 * sense, 3: 1600, 4: 1500})
        wire.send(
            "VFR_HUD", now + 4e-4, airspeed=v, groundspeed=over_ground, throttle=50, alt=100.0, climb=0.0
        )
    return wire


def found(wire):
    heard = hear([wire.columns()])
    moved = [event for event in heard.events if isinstance(event, Activity)]
    assert not heard.maneuvers or not moved
    return next((activity.text for activity in moved if activity.reason == "ground"), None)


@row("a movement in flight is a manoeuvre", {})
@row("an autopilot that says in air is believed", {"landed": 2})
@row("a converter's disarmed without ground speed grounds no flight", {"armed": False, "over_ground": 0.0})
@row("a converter's disarmed grounds no slow flight", {"speed": 9.0, "armed": False, "over_ground": 0.0})
@row("an aircraft that hangs in a strong wind flies", {"speed": 11.0, "over_ground": 0.4, "height": 80.0})
def test_what_is_flown_in_the_air(changes):
    assert found(movement(**changes)) is None


STANDS = {"speed": 6.0, "over_ground": 0.4, "height": 0.5}
DISARMED = {"speed": 6.0, "over_ground": 0.3, "armed": False, "answer": 0.05}


@row("the autopilot's landed counts", {"landed": 1}, "landed")
@row("the autopilot's take-off counts", {"landed": 3}, "takes off")
@row("a disarmed aircraft in the wind does not fly", DISARMED, "disarmed")
@row("an armed aircraft at the height of take-off does not fly", STANDS, "height of take-off")
def test_what_is_moved_on_the_ground(changes, why):
    assert why in (found(movement(**changes)) or "")


def test_a_take_off_run_and_a_crash_are_no_flight():
    assert "flying speed" in (found(movement(speed=lambda t: 1.0 + 2.5 * max(0.0, t - 4.0))) or "")
    assert found(movement(speed=lambda t: 20.0 if t < 5.5 else 1.0)) is not None


def test_what_is_flown_on_the_ground_is_not_settled_either():
    stream = FlightStream(Aircraft())
    wire = movement(landed=1)
    rows = [i for i in range(len(wire)) if i < len(wire) * 6.5 / 14]
    stream.feed(wire.columns(rows))
    assert stream.so_far() is None
    flying = FlightStream(Aircraft())
    flying.feed(movement(landed=2).columns(rows))
    assert flying.so_far() is not None
    assert np.isfinite(flying.now_s)


@pytest.mark.parametrize(("slow", "flies"), [(3.9, True), (3.7, False)])
def test_a_slow_aircraft_flies_as_long_as_its_speed_is_within_the_limit_of_change(slow, flies):
    wire = movement(speed=lambda t: slow if 3.0 < t < 4.5 else 4.5, over_ground=4.0)
    assert (found(wire) is None) == flies
