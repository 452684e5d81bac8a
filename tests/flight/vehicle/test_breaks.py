"""A gap that the advisor itself has caused is laid to the advisor, and no other gap is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.requirements import judge
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown, Span
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.pieces import DOWN
from advisor.mavlink.link.outgoing import Conversation
from advisor.oem.estimate import NoEstimate
from tests.flights import TWO, recorded
from tests.heard import hear
from tests.mavlink.link.air import Record, batches, records_of

MISSING_S = 5.2


@cache
def flight() -> list[Record]:
    return records_of(recorded("linear", 1.0, maneuvers=TWO))


@cache
def first_span() -> Span:
    """Where the first manoeuvre lies in the whole flight."""
    return flown(flight())[0][0].span


def flown(records: list[Record]) -> tuple[list[Maneuver], list[str]]:
    """The manoeuvres, and what is said of the advisor's own gaps."""
    heard = hear(batches(records, 200))
    return heard.maneuvers, [notice.text for notice in heard.notices if notice.code == "advisor_down"]


@cache
def flown_with_a_gap(note: bytes, waited_s: float = 0.0) -> tuple[list[Maneuver], list[str]]:
    return flown(with_a_gap(note, waited_s))


def with_a_gap(note: bytes, waited_s: float = 0.0) -> list[Record]:
    """The flight without 5.2 s in the first manoeuvre's free response; ``note`` stands where hearing began.

    Parameters
    ----------
    waited_s
        Time of the packets before the gap that waited in the socket and came after the note.
    """
    (attitudes,) = (c for c in next(batches(flight(), 500)) if c.name == "ATTITUDE")
    ahead_s = float(attitudes.arrival_s[0]) - int(attitudes.fields["time_boot_ms"][0]) / 1000.0
    first = first_span()
    lost_us = (first.last_step_s + 0.4 + ahead_s) * 1e6
    again_us = lost_us + MISSING_S * 1e6
    before = [r for r in flight() if r.stamp_us < lost_us - waited_s * 1e6]
    waited = [r for r in flight() if lost_us - waited_s * 1e6 <= r.stamp_us < lost_us]
    text = Conversation((), (254, 191), None).note(note, again_us / 1e6)
    late = [replace(r, stamp_us=int(again_us)) for r in waited]
    return [*before, Record(int(again_us), text), *late, *(r for r in flight() if r.stamp_us >= again_us)]


@pytest.mark.parametrize("waited_s", [0.0, 0.8])
def test_a_manoeuvre_that_the_advisor_missed_a_part_of_knows_how_much(waited_s: float) -> None:
    first, second = flown_with_a_gap(DOWN, waited_s)[0]
    assert first.missed_s == pytest.approx(MISSING_S, abs=0.1)
    assert second.missed_s == 0.0


def test_the_crew_reads_when_and_how_long_the_advisor_was_down() -> None:
    (said,) = flown_with_a_gap(DOWN, 0.0)[1]
    assert said.startswith("5.2 s are missing since 0:")
    assert said.endswith(": the advisor was down.")


def test_a_gap_of_the_radio_is_not_laid_to_the_advisor() -> None:
    maneuvers, said = flown_with_a_gap(b"a text of the vehicle")
    assert [maneuver.missed_s for maneuver in maneuvers] == [0.0, 0.0]
    assert said == []


def set_forward(by_s: float, from_s: float) -> list[Columns]:
    """The flight whose stamps since boot are later from a moment on."""
    changed = []
    for columns in (c for batch in batches(flight(), len(flight())) for c in batch):
        fields = dict(columns.fields)
        for name, unit in (("time_boot_ms", 1_000), ("time_usec", 1_000_000)):
            if name in fields:
                stamps = fields[name].astype(np.int64)
                moved = np.where(stamps >= from_s * unit, stamps + int(by_s * unit), stamps)
                fields[name] = moved.astype(fields[name].dtype)
        changed.append(replace(columns, fields=fields))
    return changed


def test_stamps_that_leap_by_hours_inside_a_manoeuvre_reject_both_parts() -> None:
    first = first_span()
    stream = FlightStream(Aircraft())
    events = [*stream.feed(set_forward(3.0 * 3600.0, first.last_step_s - 0.3)), *stream.finish()]
    found = [event.maneuver for event in events if isinstance(event, ManeuverFlown)]
    assert [round(maneuver.leapt_s / 3600.0, 2) for maneuver in found] == [3.0, 3.0, 0.0]
    for maneuver in found[:2]:
        (reason,) = judge("pitch", maneuver, NoEstimate("singular", "no fit"), Aircraft())
        assert reason.text == "the stamps leap by 3.0 h; check the vehicle's clock, fly it again"
