"""A stretch in which several controls move is one manoeuvre of both axes, however its messages arrive."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.axes.side_inputs import SideMovement, with_elevator
from advisor.flight.maneuvers.excitation import PITCH, ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import ManeuverFlown, SideManeuverFlown, Span
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, heartbeat, hud, plane_parameters, servo
from tests.flight.stream.test_stream import as_plain
from tests.heard import hear

PIECE = 36
AMPLITUDES_US = (60.0, 50.0, 55.0)
"""Aileron, elevator and rudder."""
HZ = 50.0


def sines(t: float, lines: tuple[int, ...]) -> float:
    """A sum of sines of 10 s that begins and ends at zero; 0 before and after."""
    return sum(np.sin(2.0 * np.pi * k * t / 10.0) for k in lines) / len(lines) if 0.0 < t < 10.0 else 0.0


def three_surfaces(begin_s, ends_by_mode=False, seconds=34.0):
    """A flight with sums of sines of aileron, elevator and rudder that begin at these times."""
    wire = Wire()
    heartbeat(wire, 1000.0)
    plane_parameters(wire, 1000.001)
    lines = ((3, 7, 11), (4, 8, 12), (5, 9, 13))
    rates, angles = np.zeros(3), np.zeros(3)
    for k in range(int(seconds * HZ)):
        since, boot = k / HZ, 50.0 + k / HZ
        moved = np.array([sines(since - b, one) for b, one in zip(begin_s, lines, strict=True)])
        pulses = np.round(1500.0 + np.array(AMPLITUDES_US) * moved)
        rates = rates + (8.0 * (pulses - 1500.0) / 400.0 - 4.0 * rates - 6.0 * angles) / HZ
        angles = angles + rates / HZ
        if ends_by_mode and k in (int(14.3 * HZ), int(15.3 * HZ)):
            heartbeat(wire, 1000.005 + since, mode=5)
        wire.send(
            "ATTITUDE", 1000.01 + since, time_boot_ms=round(boot * 1000), roll=angles[0], pitch=angles[1],
            yaw=0.0, rollspeed=rates[0], pitchspeed=rates[1], yawspeed=rates[2],
        )  # fmt: skip
        channels = {1: int(pulses[0]), 2: int(pulses[1]), 3: 1600, 4: int(pulses[2])}
        servo(wire, 1000.011 + since, boot, channels)
        hud(wire, 1000.012 + since, airspeed=20.0 + 0.01 * (k % 2))
    return wire


def spans(wire: Wire) -> tuple[list[Span], list[Span]]:
    """Spans of the pitch list and of the lateral list."""
    heard = hear([wire.columns()], lateral=True)
    return [m.span for m in heard.maneuvers], [m.span for m in heard.sideways]


def test_three_surfaces_at_once_are_one_manoeuvre_of_each_axis_with_one_extent():
    (pitch,), (side,) = spans(three_surfaces((4.0, 4.1, 4.2)))
    assert (pitch.start_s, pitch.last_step_s, pitch.end_s) == (side.start_s, side.last_step_s, side.end_s)
    assert pitch.start_s == pytest.approx(54.0, abs=0.2)
    assert pitch.last_step_s == pytest.approx(64.0, abs=0.5)


def test_aileron_and_rudder_that_a_mode_change_ends_together_are_one_manoeuvre():
    _, sides = spans(three_surfaces((4.0, 99.0, 4.2), ends_by_mode=True))
    assert len(sides) == 1


def test_an_elevator_after_aileron_and_rudder_is_a_manoeuvre_of_its_own():
    (pitch,), (side,) = spans(three_surfaces((4.0, 18.0, 4.2)))
    assert side.last_step_s < pitch.start_s


@pytest.mark.parametrize("begin_s", [(4.0, 4.1, 4.2), (4.0, 99.0, 4.2)])
def test_inputs_at_once_in_flight_are_those_of_a_replay(begin_s: tuple[float, float, float]):
    wire = three_surfaces(begin_s)
    stream, live = FlightStream(Aircraft(), lateral=True), []
    for i in range(0, len(wire), PIECE):
        live += stream.feed(wire.columns(range(i, min(i + PIECE, len(wire)))))
    live += stream.finish()
    whole = FlightStream(Aircraft(), lateral=True)
    replayed = whole.feed(wire.columns()) + whole.finish()
    for kind in (ManeuverFlown, SideManeuverFlown):
        ours, theirs = ([e for e in events if isinstance(e, kind)] for events in (live, replayed))
        assert len(ours) == len(theirs)
        for one, other in zip(ours, theirs, strict=True):
            assert (one.maneuver.number, one.maneuver.span) == (other.maneuver.number, other.maneuver.span)
    assert as_plain([e for e in live if isinstance(e, ManeuverFlown)]) == as_plain(
        [e for e in replayed if isinstance(e, ManeuverFlown)]
    )


def movement(loop: Loop, start_s: float, last_s: float, level: float = 0.1) -> SideMovement:
    steps = ((start_s, level), (last_s, 0.0))
    return SideMovement(loop, Span(start_s - 1.0, start_s, last_s, last_s + 3.0, "other", steps, "quiet"))


@pytest.mark.parametrize(
    ("side", "joins"),
    [
        (movement(ROLL, 10.0, 20.0), True),
        (movement(ROLL, 15.1, 20.0), False),
        (movement(ROLL, 10.0, 31.0), False),
        (movement(ROLL, 10.0, 20.0, 0.02), False),
    ],
    ids=["the whole time", "less than half of the time", "twice as long", "a fifth of the amplitude"],
)
def test_a_control_joins_the_elevator_that_moves_as_long_and_as_far(side: SideMovement, joins: bool):
    elevator = movement(PITCH, 10.0, 20.0)
    assert bool(with_elevator(elevator, [side])) is joins
    assert with_elevator(elevator, [movement(YAW, 10.0, 20.0, 1.0)]) == ()
