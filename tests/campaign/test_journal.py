"""The event log stands on the vehicle's clock and never runs backwards."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.journal import Journal
from advisor.flight.maneuvers.maneuver import FlightBegan, ModeChanged, Rebooted, VehicleFound, VehicleSaid
from advisor.flight.vehicle.pieces import rows_between
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.mavlink.logs.logs import open_log
from tests.flights import TWO, recorded

VEHICLE = Vehicle(1, 1, "ardupilot", 1)


def lines(journal: Journal) -> list[str]:
    return [line.strip() for line in journal.lines]


def test_before_the_vehicles_clock_is_heard_a_sentence_has_no_time():
    journal = Journal()
    journal.write("waiting")
    assert lines(journal) == ["–  waiting"]


def test_a_sentence_without_a_time_of_its_own_stands_at_the_newest_time():
    journal = Journal()
    journal.write("mode MANUAL", 80.0)
    journal.write("noted")
    assert lines(journal)[-1] == "1:20.0  noted"


def test_a_sentence_on_something_earlier_stands_at_the_newest_time_and_says_when_it_was():
    journal = Journal()
    journal.write("mode MANUAL", 80.0)
    journal.write("mark: flaps", 60.0)
    assert lines(journal)[-1] == "1:20.0  at 1:00.0, mark: flaps"


@pytest.mark.parametrize("event", [Rebooted(1), FlightBegan(1, "b.tlog"), VehicleFound(VEHICLE)])
def test_where_another_clock_begins_times_begin_anew_and_a_sentence_says_so(event):
    journal = Journal()
    journal.write("mode MANUAL", 80.0)
    journal.take(event)
    journal.take(ModeChanged("FBWA", 3.0))
    assert "power-on" in lines(journal)[1]
    assert lines(journal)[1].startswith("–")
    assert lines(journal)[2] == "0:03.0  mode FBWA"


def test_a_vehicles_text_stands_with_its_severity_and_another_sender_with_its_number():
    journal = Journal()
    journal.take(VehicleFound(VEHICLE))
    journal.take(VehicleSaid("EKF variance", "warning", 1, 1, 80.0))
    journal.take(VehicleSaid("camera ready", "info", 1, 100, 81.0))
    journal.take(VehicleSaid("ready", "", 1, 1, 82.0))
    assert lines(journal)[1:] == [
        "1:20.0  vehicle, warning: EKF variance",
        "1:21.0  system 1/100, info: camera ready",
        "1:22.0  vehicle: ready",
    ]


def test_a_text_that_is_repeated_word_for_word_stands_once():
    journal = Journal()
    for at_s in range(30):
        journal.take(VehicleSaid("PreArm: check compass", "critical", 1, 1, float(at_s)))
    assert len(journal.lines) == 1


def test_however_much_a_vehicle_says_the_log_stays_bounded():
    journal = Journal()
    for k in range(3000):
        journal.take(VehicleSaid(f"text {k}", "info", 1, 1, 0.1 * k))
    assert len(journal.lines) == 1000


def _logged(log: Path, rows: int | None) -> tuple[str, ...]:
    """The event log of a recording that arrives whole, or in pieces of so many bytes."""
    campaign = Campaign(Aircraft())
    for batch in open_log(log):
        if rows is None:
            campaign.feed(batch)
            continue
        past = max(int(c.order[-1]) for c in batch) + 1
        for first in range(0, past, rows):
            campaign.feed(rows_between(batch, first, first + rows))
    campaign.finish()
    return campaign.state.notices


def test_the_event_log_does_not_depend_on_how_messages_arrive_and_its_times_run_forward():
    log = recorded("linear", 1.0, maneuvers=TWO[:1])
    whole = _logged(log, None)
    assert _logged(log, 10_000) == whole
    times = [line[:7].strip() for line in whole if line[:7].strip() != "–"]
    seconds = [60.0 * int(m) + float(s) for m, _, s in (t.partition(":") for t in times)]
    assert len(seconds) > 3
    assert seconds == sorted(seconds)


@pytest.mark.parametrize(("behind_s", "named"), [(0.9, ""), (1.1, "at 1:18.9, ")])
def test_a_sentence_more_than_a_second_behind_names_the_time_of_its_event(behind_s, named):
    journal = Journal()
    journal.write("mode MANUAL", 80.0)
    journal.write("a manoeuvre", 80.0 - behind_s)
    assert lines(journal)[1] == f"1:20.0  {named}a manoeuvre"
