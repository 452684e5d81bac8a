"""A limit of the elevator that is heard late counts for the manoeuvres before, or leaves them out by name."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.late_limits import recount
from advisor.flight.elevator.elevator_sign import turned
from advisor.flight.maneuvers.events import ElevatorRescaled
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.flight.vehicle.surfaces import Part, Scale, Surface
from tests.flight.columns import Wire, fly, parameter

ASSUMED, HEARD = Scale(), Scale(1000.0, 1520.0, 2000.0)
PULSES = np.array([1500.0, 1600.0, 1950.0, 1050.0, 1500.0])
STRETCH = 100
"""Messages that arrive together: half a second."""
TRIED = [("SERVO2_MIN", 1000.0), ("SERVO2_TRIM", 1510.0), ("SERVO2_MAX", 2000.0)]


def surface(*scales: Scale) -> Surface:
    share = 1.0 / len(scales)
    return Surface(tuple(Part(n, scale, share) for n, scale in enumerate(scales, start=2)), False, "")


def record(scale: Scale | None, number: int = 1) -> Maneuver:
    """A manoeuvre whose pulses are counted by a scale."""
    y = (scale or ASSUMED).deflection(PULSES)
    t = np.arange(5.0)
    span = Span(0.0, 1.0, 3.0, 4.0, "other", ((1.0, float(y[1] - y[0])), (3.0, float(y[3] - y[0]))), "quiet")
    elevator = Channel("elevator", t, y, "SERVO_OUTPUT_RAW.servo2_raw", "commanded")
    return Maneuver(number, 0, span, {"elevator": elevator}, scale=scale)


def late(before: Surface, after: Surface) -> ElevatorRescaled:
    return ElevatorRescaled(before, after, "SERVO2_MIN 1000 is heard only at 1:00.0")


def test_pulses_beyond_the_assumed_limits_are_counted_anew_to_the_last_digit() -> None:
    (scaled,) = recount([record(ASSUMED)], late(surface(ASSUMED), surface(HEARD))).anew
    right = record(HEARD)
    assert scaled.scale == HEARD
    assert scaled.channels["elevator"].y == pytest.approx(right.channels["elevator"].y, abs=1e-12)
    assert np.array(scaled.span.steps) == pytest.approx(np.array(right.span.steps), abs=1e-12)


def test_a_manoeuvre_whose_sign_the_aircraft_decided_keeps_the_sign() -> None:
    (scaled,) = recount([turned(record(ASSUMED))], late(surface(ASSUMED), surface(HEARD))).anew
    assert scaled.channels["elevator"].y == pytest.approx(-HEARD.deflection(PULSES), abs=1e-12)


def test_manoeuvres_of_several_outputs_are_left_out_by_name() -> None:
    both = late(surface(ASSUMED, ASSUMED), surface(HEARD, ASSUMED))
    found = recount([record(None), record(None, 2)], both)
    assert (found.anew, found.lost) == ((), (1, 2))
    assert found.notice is not None
    assert "manoeuvres 1, 2 had an assumed value and are excluded" in found.notice.text


def test_a_manoeuvre_on_another_scale_and_one_of_another_log_stay() -> None:
    found = recount(
        [record(Scale(1200.0)), replace(record(ASSUMED, 2), flight=1)], late(surface(ASSUMED), surface(HEARD))
    )
    assert (found.anew, found.lost, found.notice) == ((), (), None)


def flown(late_s: Sequence[float], stated: Sequence[tuple[str, float]] = ()) -> Campaign:
    """A campaign of two inputs, with limits stated at the beginning, and others heard at these times."""
    wire, campaign = Wire(), Campaign(Aircraft())
    for name, value in stated:
        parameter(wire, 999.0, name, value)
    fly(wire, 1000.0, 50.0, [4.0, 16.0], 28.0)
    for at_s, (name, value) in zip(late_s, TRIED, strict=False):
        parameter(wire, 1000.0 + at_s, name, value)
    rows = range(len(wire))
    for first in rows[::STRETCH]:
        campaign.feed(wire.columns(list(rows[first : first + STRETCH])))
    campaign.finish()
    return campaign


def test_limits_heard_between_and_within_manoeuvres_give_what_limits_heard_at_once_give() -> None:
    """The second limit arrives in the middle of the second input."""
    at_once, late_heard = flown([], TRIED), flown([13.0, 17.0, 27.5])
    mine, right = ([j.maneuver for j in campaign.state.maneuvers] for campaign in (late_heard, at_once))
    assert len(mine) == len(right) == 2
    for one, other in zip(mine, right, strict=True):
        assert one.channels["elevator"].t == pytest.approx(other.channels["elevator"].t)
        assert one.channels["elevator"].y == pytest.approx(other.channels["elevator"].y, abs=1e-12)
        assert one.scale == other.scale
    told = [line for line in late_heard.state.notices if "counted anew" in line]
    assert ["manoeuvres 1 are" in line for line in told] == [True, True, False]
    assert len(late_heard.state.reader_notes) == 3
