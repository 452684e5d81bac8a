"""A log of any kind is known as a whole: its parameters count from its start."""

import struct
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.analysis.marks_file import LogSeries
from advisor.flight.maneuvers.maneuver import (
    READER_NOTICE,
    FlightEvent,
    ManeuverAgain,
    ManeuverFlown,
    Notice,
    VehicleFound,
)
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.flights import Flights
from advisor.flight.vehicle.parameters import names_in
from advisor.mavlink.logs.logs import open_log, read_whole_log
from advisor.words.problems import UnusableInputError
from tests.mavlink.builders import Sender, dialect
from tests.mavlink.paths import records

BASE = Path(__file__).parents[2] / "cases" / "t_base.tlog"
"""A manoeuvre between its parameters and its landing."""
PARAM_VALUE = 22

Record = tuple[int, bytes]


def is_parameter(record: Record) -> bool:
    frame = record[1]
    number = frame[5] if frame[0] == 0xFE else int.from_bytes(frame[7:10], "little")
    return number == PARAM_VALUE


def written(path: Path, every: Sequence[Record]) -> Path:
    path.write_bytes(b"".join(struct.pack(">Q", stamp_us) + frame for stamp_us, frame in every))
    return path


def arranged(path: Path, order: Callable[[list[Record], list[Record]], list[Record]]) -> Path:
    """The base log with its parameters and its other records in another order."""
    every = list(records(BASE.read_bytes()))
    last_us = every[-1][0]
    parameters = [(last_us, frame) for stamp_us, frame in filter(is_parameter, every)]
    return written(path, order(parameters, [one for one in every if not is_parameter(one)]))


@pytest.fixture
def late(tmp_path: Path) -> Path:
    """The base log whose parameters came after the landing."""
    return arranged(tmp_path / "late.tlog", lambda parameters, others: others + parameters)


@pytest.fixture
def without(tmp_path: Path) -> Path:
    """The base log without parameters, a day later."""
    day_us = 86_400_000_000
    return arranged(
        tmp_path / "without.tlog",
        lambda _, others: [(stamp_us + day_us, frame) for stamp_us, frame in others],
    )


def flown(batches: Iterator[list[Columns]], names: Sequence[str] = ()) -> tuple[Flights, list[FlightEvent]]:
    flights = Flights(Aircraft(), names=names)
    events = [event for columns in batches for event in flights.feed(columns)]
    return flights, [*events, *flights.finish()]


def elevators(events: Sequence[FlightEvent]) -> list[np.ndarray]:
    return [event.maneuver.channels["elevator"].y for event in events if isinstance(event, ManeuverFlown)]


def test_parameters_written_after_the_landing_count_from_the_start(late: Path) -> None:
    _, events = flown(read_whole_log(late))
    _, sound = flown(open_log(BASE))
    assert [y.tolist() for y in elevators(events)] == [y.tolist() for y in elevators(sound)]
    assert len(elevators(events)) == 1


def test_a_link_cannot_know_a_later_parameter(late: Path) -> None:
    _, events = flown(open_log(late))
    assert elevators(events) == []


def test_of_two_values_in_one_log_the_first_counts_from_the_start(tmp_path: Path) -> None:
    """The second value keeps its place, where the stream treats it as a change."""
    sender = Sender()
    frames = [
        sender.frame(dialect.MAVLink_param_value_message(b"SERVO2_MAX", value, 9, 1, 0))
        for value in (1900.0, 2000.0)
    ]
    log = arranged(
        tmp_path / "two.tlog",
        lambda parameters, others: others + parameters + [(others[-1][0], frame) for frame in frames],
    )
    moved = [c for c in next(read_whole_log(log)) if c.name == "PARAM_VALUE" and c.order[0] < 0]
    stated = dict(zip(names_in(moved[0]), moved[0].fields["param_value"].tolist(), strict=True))
    assert stated["SERVO2_MAX"] == 1900.0


def test_a_log_without_parameters_takes_those_of_the_campaigns_other_log(without: Path) -> None:
    series = LogSeries([BASE, without])
    _, events = flown(series.batches(), series.names)
    # Both logs hold one flight, so that the second log's manoeuvre is the first one again.
    assert len([e for e in events if isinstance(e, ManeuverAgain)]) == 1
    assert any("The parameters in t_base.tlog count" in e.text for e in events if isinstance(e, Notice))


def test_the_gap_lends_parameters_from_the_campaigns_other_log_too(without: Path) -> None:
    flights = maneuvers_of([without, BASE], Aircraft())
    assert flights.again == 1
    assert any("The parameters in t_base.tlog count" in note for note in flights.notes)


def test_no_log_lends_what_the_log_itself_states(late: Path) -> None:
    _, events = flown(read_whole_log(late, [BASE]))
    assert not [e for e in events if isinstance(e, Notice) and e.code == READER_NOTICE]


def with_an_idle_vehicle(path: Path, idle_mode: int) -> Path:
    """The base log, armed throughout, after the heartbeats of a vehicle with this base_mode."""
    idle, flying = Sender(42), Sender(1)
    every = list(records(BASE.read_bytes()))
    begin_us = every[0][0]
    beats: list[Record] = []
    for sender, mode in ((idle, idle_mode), (flying, 217)):
        heartbeat = dialect.MAVLink_heartbeat_message(1, 3, mode, 0, 4, 3)
        beats.append((begin_us, sender.frame(heartbeat)))
    return written(path, [*beats, *every])


def test_the_vehicle_that_flew_is_followed_though_an_idle_one_is_heard_first(tmp_path: Path) -> None:
    flights, events = flown(read_whole_log(with_an_idle_vehicle(tmp_path / "two.tlog", idle_mode=81)))
    assert flights.stream.vehicle is not None
    assert flights.stream.vehicle.system == 1
    assert len(elevators(events)) == 1
    assert any("Vehicle 1 is followed" in e.text for e in events if isinstance(e, Notice))


def test_of_two_armed_vehicles_a_log_chooses_none(tmp_path: Path) -> None:
    _, events = flown(read_whole_log(with_an_idle_vehicle(tmp_path / "two.tlog", idle_mode=217)))
    assert next(e.vehicle.system for e in events if isinstance(e, VehicleFound)) == 42


def test_the_diagnosis_leaves_out_a_log_that_cannot_be_read_and_names_it(tmp_path: Path) -> None:
    broken = tmp_path / "broken.tlog"
    broken.write_bytes(b"no log at all" * 100)
    both, alone = maneuvers_of([broken, BASE], Aircraft()), maneuvers_of([BASE], Aircraft())
    assert len(both.maneuvers) == len(alone.maneuvers)
    assert [note for note in both.notes if note.startswith("Left out: broken.tlog")]
    with pytest.raises(UnusableInputError, match=r"broken.tlog"):
        maneuvers_of([broken, broken], Aircraft())
