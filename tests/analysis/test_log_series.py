"""Several logs are one campaign: numbered through, each manoeuvre once, each decision with its log."""

import json
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.analysis.marks_file import LogSeries, write_by_hand
from advisor.campaign.campaign import Campaign, CampaignEvent
from advisor.campaign.state import ByHand, Remark
from advisor.cli.group import main
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown, are_one
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from tests.flights import TWO, recorded
from tests.mavlink.paths import Way, heard_over, records
from tests.schemas import breaches

DAY_US = 86_400_000_000

CASES = Path(__file__).parents[1] / "cases"
"""One flight, cut to a manoeuvre, as three kinds of log."""


def flight(tmp_path: Path, name: str, seed: int, day: int = 0) -> Path:
    """A log of one manoeuvre, flown on a day."""
    log = b"".join(
        struct.pack(">Q", stamp_us + day * DAY_US) + frame
        for stamp_us, frame in records(recorded("uav", 1.0, seed, TWO[:1]).read_bytes())
    )
    path = tmp_path / name
    path.write_bytes(log)
    return path


def followed(*logs: Path, by_hand: ByHand | None = None) -> Campaign:
    series = LogSeries(logs)
    campaign = Campaign(Aircraft(), by_hand=by_hand or series.read_by_hand(), names=series.names)
    for columns in series.batches():
        campaign.feed(columns)
    campaign.finish()
    return campaign


def found(log: Path) -> list[Maneuver]:
    """The manoeuvres of one log, which nobody estimates."""
    stream = FlightStream(Aircraft())
    events = [event for columns in LogSeries([log]).batches() for event in stream.feed(columns)]
    return [event.maneuver for event in events + stream.finish() if isinstance(event, ManeuverFlown)]


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    exit_code: int
    stdout: str
    stderr: str

    @property
    def document(self) -> dict[str, Any]:
        return json.loads(self.stdout)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    """Runs ``advisor`` with these arguments."""

    def ran(*arguments: object) -> Ended:
        monkeypatch.setattr("sys.argv", ["advisor", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        told = capsys.readouterr()
        return Ended(int(left.value.code or 0), told.out, told.err)

    return ran


def spread(campaign: Campaign) -> np.ndarray:
    assert campaign.state.model is not None
    return campaign.state.model.covariance


@pytest.fixture
def first(tmp_path: Path) -> Path:
    return flight(tmp_path, "first.tlog", 1)


@pytest.fixture
def second(tmp_path: Path) -> Path:
    return flight(tmp_path, "second.tlog", 2, day=1)


def test_manoeuvres_of_two_flights_of_one_schedule_are_numbered_through(first: Path, second: Path) -> None:
    maneuvers = [j.maneuver for j in followed(first, second).state.maneuvers]
    assert [(m.number, m.flight) for m in maneuvers] == [(1, 0), (2, 1)]


def test_the_diagnosis_takes_logs_in_the_order_of_their_times_and_says_so(first: Path, second: Path) -> None:
    forward, backward = (maneuvers_of(logs, Aircraft()) for logs in ([first, second], [second, first]))
    assert [m.span for m in backward.maneuvers] == [m.span for m in forward.maneuvers]
    assert "The logs are taken in the order of their times: first.tlog, second.tlog." in backward.notes
    assert forward.notes == backward.notes[1:]


def test_a_log_among_others_gives_the_manoeuvres_that_it_gives_alone(first: Path, second: Path) -> None:
    together = [j.maneuver for j in followed(first, second).state.maneuvers if j.maneuver.flight == 1]
    alone = found(second)
    assert [m.span for m in together] == [m.span for m in alone]
    assert all(
        np.array_equal(a.channels["q"].y, b.channels["q"].y) for a, b in zip(together, alone, strict=True)
    )


@pytest.mark.parametrize("copied", [True, False])
def test_a_file_given_twice_and_a_copy_count_once(first: Path, tmp_path: Path, copied: bool) -> None:
    again = tmp_path / "copy.tlog" if copied else first
    again.write_bytes(first.read_bytes())
    assert np.array_equal(spread(followed(first, again)), spread(followed(first)))


def test_two_stations_that_lose_differently_by_clocks_of_their_own_count_once(first, tmp_path):
    stations = []
    for number, loss in enumerate((0.02, 0.05)):
        path = tmp_path / f"station-{number}.tlog"
        heard = records(heard_over(first, Way(loss=loss), seed=number))
        path.write_bytes(b"".join(struct.pack(">Q", at + 7_000_000 * number) + frame for at, frame in heard))
        stations.append(path)
    both = followed(*stations)
    assert len(both.state.maneuvers) == 1
    assert np.diag(spread(both)) == pytest.approx(np.diag(spread(followed(first))), rel=0.15)


PARAM_VALUE = 22


def part(log: Path, name: str, from_s: float, to_s: float) -> Path:
    """The records of a stretch of a log, and its parameters."""
    found = list(records(log.read_bytes()))
    begin_us = found[0][0]
    path = log.with_name(name)
    path.write_bytes(
        b"".join(
            struct.pack(">Q", at) + frame
            for at, frame in found
            if from_s <= 1e-6 * (at - begin_us) < to_s or frame[7] == PARAM_VALUE
        )
    )
    return path


def test_of_logs_that_overlap_the_whole_record_of_a_manoeuvre_counts(first: Path) -> None:
    (last,) = found(first)
    began_s = recorded_from_s(first)
    within_s = last.span.start_s + 1.0 - began_s
    early, late = part(first, "early.tlog", 0.0, within_s), part(first, "late.tlog", within_s - 10.0, 1e6)
    maneuvers = [j.maneuver for j in followed(early, late).state.maneuvers]
    assert [m.number for m in maneuvers] == [1]
    assert maneuvers[0].flight == 1
    assert maneuvers[0].span == last.span


def recorded_from_s(log: Path) -> float:
    """Vehicle time at the start of a log, s since boot, by its first ATTITUDE."""
    columns = next(LogSeries([log]).batches())
    (attitude,) = (c for c in columns if c.name == "ATTITUDE")
    (first_s,) = (min(float(c.arrival_s[0]) for c in columns),)
    return float(attitude.fields["time_boot_ms"][0]) * 1e-3 - (float(attitude.arrival_s[0]) - first_s)


def test_a_log_and_the_vehicles_own_log_of_one_flight_count_once() -> None:
    state = followed(CASES / "base.bin", CASES / "t_base.tlog").state
    assert [j.maneuver.number for j in state.maneuvers] == [1]


def test_noise_alone_tells_two_flights_of_one_schedule_apart(first: Path, second: Path) -> None:
    (a, *_), (b, *_) = (found(log) for log in (first, second))
    assert a.span.start_s == pytest.approx(b.span.start_s, abs=0.05)
    assert are_one(a, a)
    assert not are_one(a, b)


def test_logs_are_taken_in_the_order_of_their_times_and_that_is_said(first: Path, second: Path) -> None:
    series = LogSeries([second, first])
    assert series.logs == [first, second]
    assert series.order_said.endswith("first.tlog, second.tlog.")
    assert LogSeries([first, second]).order_said == ""


def test_decisions_by_hand_stay_with_their_log(first: Path, second: Path) -> None:
    (start_s, *_) = (maneuver.span.start_s for maneuver in found(second))
    write_by_hand(second, ByHand(excluded=(Remark(start_s, "stick not free"),)))
    campaign = followed(first, second)
    reasons = [j.excluded_because for j in campaign.state.maneuvers]
    assert reasons == [None, "stick not free"]
    campaign.engineer.exclude(1, "gust")
    assert [r.text for r in campaign.engineer.decided.on_flight(0).excluded] == ["gust"]
    assert [r.text for r in campaign.engineer.decided.on_flight(1).excluded] == ["stick not free"]


def test_the_document_of_several_logs_says_what_is_of_which(first, second, run):
    result = run("analyze", first, second, "--json")
    document = result.document
    assert result.exit_code == 0
    assert breaches("analyze", document) == []
    assert [entry["file"] for entry in document["logs"]] == [str(first), str(second)]
    assert [m["log"] for m in document["maneuvers"]] == [str(first), str(second)]
    assert document["problems"] == []


def test_the_document_of_one_log_has_no_list_of_logs(first: Path, run: Callable[..., Ended]) -> None:
    document = run("analyze", first, "--json").document
    assert breaches("analyze", document) == []
    assert "logs" not in document
    assert "log" not in document["maneuvers"][0]


def test_a_log_that_cannot_serve_is_named_and_the_others_count(first, tmp_path, run):
    broken = tmp_path / "broken.tlog"
    broken.write_bytes(b"no log at all" * 100)
    result = run("analyze", first, broken, tmp_path / "missing.tlog", "--json")
    document = result.document
    assert result.exit_code == 0
    assert document["usable"]
    assert [p["code"] for p in document["problems"]] == ["not_a_tlog", "no_such_file"]
    assert "broken.tlog" in result.stderr
    assert "missing.tlog" in result.stderr


def test_a_log_whose_messages_break_the_analysis_is_left_out_and_the_others_count(
    first: Path, second: Path, run: Callable[..., Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = Campaign.feed

    def feed(campaign: Campaign, columns: list[Columns]) -> list[CampaignEvent]:
        if columns[0].flight == 0:
            raise ZeroDivisionError("two records with one stamp")
        return sound(campaign, columns)

    monkeypatch.setattr(Campaign, "feed", feed)
    result = run("analyze", first, second, "--json")
    assert result.exit_code == 0
    assert len(result.document["maneuvers"]) > 0
    assert "first.tlog: Its messages cause an error in the analysis (ZeroDivisionError" in result.stderr


def test_when_no_log_can_serve_all_problems_are_told(tmp_path: Path, run: Callable[..., Ended]) -> None:
    result = run("analyze", tmp_path / "a.tlog", tmp_path / "b.tlog", "--json")
    document = result.document
    assert result.exit_code == 3
    assert not document["usable"]
    assert len(document["problems"]) == 2


def test_a_mark_of_the_command_line_needs_a_single_log(first, second, run):
    for command in ("analyze", "replay"):
        result = run(command, first, second, "--maneuver", "+1:+9")
        assert result.exit_code == 2
        assert "LOG.maneuvers.yaml" in result.stderr


def test_the_log_of_another_kind_of_autopilot_is_refused_by_name(first, run):
    document = run("analyze", first, CASES / "u_base.ulg", "--json").document
    assert [p["code"] for p in document["problems"]] == ["other_vehicle"]


def order_of(logs: Sequence[Path]) -> list[str]:
    return [log.name for log in LogSeries(logs).logs]


def test_logs_without_dates_stay_in_the_order_given(first: Path, tmp_path: Path) -> None:
    undated = tmp_path / "undated.tlog"
    undated.write_bytes(
        b"".join(struct.pack(">Q", 5_000_000) + frame for _, frame in records(first.read_bytes()))
    )
    assert order_of([first, undated]) == ["first.tlog", "undated.tlog"]
    assert order_of([undated, first]) == ["undated.tlog", "first.tlog"]
