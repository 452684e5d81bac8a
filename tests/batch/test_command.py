"""``advisor batch``: the numbers of ``analyze``, each log once, failures listed, resumable."""

import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.batch.flight import (
    AircraftMap,
    Analyzed,
    BatchTask,
    failed,
    find_logs,
    kept,
    read_map,
    sha256_of,
)
from advisor.batch.tables import aircraft_of, is_whole, mixed_up
from advisor.cli.batch import write_reports
from advisor.process.tasks import processes
from advisor.process.tasks.processes import run_here
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import Noise, Scenario
from tests.conftest import Advisor
from tests.flights import SHIPPED, TWO, recorded
from tests.full_disk import files_of_at_most

Work = Callable[[BatchTask], Analyzed]
Results = Iterator[tuple[BatchTask, Analyzed | Exception]]
ONE = TWO[:1]
CASES = Path(__file__).parents[1] / "cases"
"""One flight, cut to a manoeuvre, as three kinds of log."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two flights of one manoeuvre, a copy of the first, and a log that holds nothing."""
    place = tmp_path / "flights"
    (place / "2026").mkdir(parents=True)
    for seed in (11, 12):
        shutil.copy(recorded("linear", 1.0, seed, ONE), place / f"flight-{seed}.tlog")
    shutil.copy(place / "flight-11.tlog", place / "2026" / "copy.tlog")
    (place / "empty.bin").write_bytes(b"")
    (place / "notes.txt").write_text("no log")
    return place


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Analyze in this process: a fresh one imports for seconds before its first log."""
    monkeypatch.setattr(processes, "run_in_processes", lambda work, tasks, workers: run_here(work, tasks))


@pytest.mark.parametrize(
    "change",
    [
        {"document": {"usable": True, "problems": []}},
        {"document": []},
        {"joint": {"theta": [1.0]}},
        {"began_s": "yesterday"},
    ],
)
def test_a_result_of_another_shape_is_no_result(change: dict[str, object]) -> None:
    task = BatchTask(CASES / "t_base.tlog", Aircraft(), "", "0" * 64)
    sound = failed(task, [Problem("no_vehicle", "No vehicle.", "Record one.")])
    assert is_whole(sound)
    assert not is_whole(replace(sound, **change))


@pytest.mark.usefixtures("in_this_process")
def test_a_stored_result_of_another_shape_is_computed_again(advisor: Advisor, tmp_path: Path) -> None:
    log, out = tmp_path / "short.tlog", tmp_path / "out"
    log.write_bytes((SHIPPED / "arduplane-default-rates.tlog").read_bytes()[:40_000])
    advisor("batch", log, "-o", out, "--workers", 1)
    (stored,) = (out / "flights").glob("*.json")
    sound = stored.read_text()
    stored.write_text(json.dumps({**json.loads(sound), "document": {"usable": True, "problems": []}}))
    assert advisor("batch", log, "-o", out, "--workers", 1).returncode in (0, 3)
    assert stored.read_text() == sound


@pytest.mark.usefixtures("in_this_process")
def test_rows_have_the_numbers_of_analyze_and_failures_their_reason(folder, advisor, tmp_path):
    run = advisor("batch", folder, "-o", tmp_path / "out", "--workers", 1)
    assert run.returncode == 0, run.stderr
    assert "is a copy of" in run.stderr
    assert f"{folder / 'empty.bin'}: empty.bin is empty." in run.stderr
    assert "3 of 3 logs" in run.stderr
    flights = pq.read_table(tmp_path / "out" / "flights.parquet").to_pylist()
    maneuvers = pq.read_table(tmp_path / "out" / "maneuvers.parquet").to_pylist()
    assert [row["usable"] for row in flights].count(False) == 1
    for row in [row for row in flights if row["usable"]][-1:]:
        told = json.loads(advisor("analyze", row["log"], "--json").stdout)
        assert {name: row[name] for name in PARAMETERS} == {
            name: told["model"][name]["value"] for name in PARAMETERS
        }
        mine = [m for m in maneuvers if m["flight"] == row["flight"]]
        assert [m["sentence"] for m in mine] == [m["sentence"] for m in told["maneuvers"]]
        assert [m["M_q_std"] for m in mine] == [m["estimates"]["M_q"]["std"] for m in told["maneuvers"]]
    assert len(maneuvers) == 2


@pytest.mark.study
def test_a_centre_of_gravity_that_has_moved_is_told_since_its_first_flight(advisor, tmp_path):
    for number in range(1, 6):
        aft = {"cg_shift": {"aft_m": 0.015, "at_s": 0.0}} if number >= 4 else {}
        noise = Noise(percent=1.0)
        scenario = Scenario(aircraft="uav", noise=noise, seed=number, maneuvers=TWO, effects=aft)
        record(flight_of(scenario), tmp_path / f"flight-{number}.tlog")
    (tmp_path / "uav.yaml").write_text("name: uav\n")
    run = advisor(
        "batch", tmp_path, "-o", tmp_path / "out", "--workers", 1, "--aircraft", tmp_path / "uav.yaml"
    )
    assert "Since flight 4 M_α is 35 % smaller; it looks like a shift of the centre of gravity." in run.stdout
    (row,) = pq.read_table(tmp_path / "out" / "changes.parquet").to_pylist()
    assert (row["since_flight"], row["parameter"], row["confirmed"]) == (4, "M_alpha", True)


@pytest.mark.usefixtures("in_this_process")
def test_the_second_run_analyzes_nothing_and_gives_the_same_tables_and_page(folder, advisor, tmp_path):
    out = tmp_path / "out"
    advisor("batch", folder, "-o", out, "--workers", 1)
    before = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
    assert "Cannot be used: empty.bin is empty." in before["index.html"].decode()
    stamps = {path: path.stat().st_mtime_ns for path in (out / "flights").iterdir()}
    run = advisor("batch", folder, "-o", out, "--workers", 1)
    assert "3 of 3 logs were analyzed before." in run.stderr
    assert {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()} == before
    assert {path: path.stat().st_mtime_ns for path in (out / "flights").iterdir()} == stamps


@pytest.mark.usefixtures("in_this_process")
def test_many_logs_are_analyzed_once(advisor: Advisor, tmp_path: Path) -> None:
    logs, out = tmp_path / "logs", tmp_path / "out"
    logs.mkdir()
    shutil.copy(CASES / "t_base.tlog", logs)
    beginning = (SHIPPED / "arduplane-default-rates.tlog").read_bytes()[:40_000]
    for number in range(5):
        # Bytes of no meaning make each a log of its own.
        (logs / f"flight-{number:02}.tlog").write_bytes(beginning + bytes(number))
    first = advisor("batch", logs, "-o", out, "--workers", 1)
    assert first.returncode == 0, first.stderr
    assert "6 of 6 logs, " in first.stderr
    made = {path: (path.stat().st_mtime_ns, path.stat().st_ino) for path in (out / "flights").iterdir()}
    assert len(made) == 6
    second = advisor("batch", logs, "-o", out, "--workers", 1)
    assert "6 of 6 logs were analyzed before." in second.stderr
    assert " a minute" not in second.stderr
    assert {path: (path.stat().st_mtime_ns, path.stat().st_ino) for path in made} == made


def test_logs_of_two_aircraft_with_one_file_are_told_in_one_sentence_and_not_compared() -> None:
    one, two = (_flown(f"{name}.tlog", system) for name, system in (("a", 1), ("b", 2)))
    assert mixed_up([one, one]) == []
    (sentence,) = mixed_up([one, two])
    assert "my.yaml ardupilot system 1 in a.tlog; my.yaml ardupilot system 2 in b.tlog." in sentence
    assert "--aircraft-map" in sentence
    assert len({aircraft_of(one), aircraft_of(two)}) == 2


def _flown(log: str, system: int) -> Analyzed:
    vehicle = {"system": system, "component": 1, "autopilot": "ardupilot"}
    return Analyzed(log, "my.yaml", "", 0.0, {"usable": True, "log": {"vehicle": vehicle}})


@pytest.mark.usefixtures("in_this_process")
def test_a_disk_that_fills_up_ends_the_batch_with_one_sentence_and_no_half_result(folder, advisor, tmp_path):
    with files_of_at_most(5_000):
        run = advisor("batch", folder / "flight-11.tlog", "-o", tmp_path / "out", "--workers", 1)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert run.stderr.startswith(f"-o: {tmp_path / 'out'} cannot be written to: File too large.")
    assert [path for path in (tmp_path / "out").rglob("*") if path.is_file()] == []


@pytest.mark.study
def test_two_processes_give_the_tables_of_one(folder: Path, advisor: Advisor, tmp_path: Path) -> None:
    for workers in (1, 2):
        advisor("batch", folder, "-o", tmp_path / f"out-{workers}", "--workers", workers)
    assert_same_tables(tmp_path / "out-1", tmp_path / "out-2")


def test_results_that_come_in_another_order_give_the_same_tables(folder, advisor, tmp_path, monkeypatch):
    for way in (1, -1):

        def run(work: Work, tasks: list[BatchTask], workers: int, way: int = way) -> Results:
            return run_here(work, tasks[::way])

        monkeypatch.setattr(processes, "run_in_processes", run)
        advisor("batch", folder, "-o", tmp_path / f"out{way}", "--workers", 1)
    assert_same_tables(tmp_path / "out1", tmp_path / "out-1")


def assert_same_tables(*folders: Path) -> None:
    for name in ("flights", "maneuvers", "changes"):
        one, two = (folder / f"{name}.parquet" for folder in folders)
        assert one.read_bytes() == two.read_bytes()


def test_the_key_changes_with_the_log_the_configuration_and_what_was_decided_by_hand(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    log.write_bytes(b"a log")
    task = BatchTask(log, Aircraft(), "", sha256_of(log))
    keys = [
        task.key,
        BatchTask(log, Aircraft(), "", "another").key,
        BatchTask(log, Aircraft(airspeed_m_s=20.0), "", task.sha256).key,
    ]
    (tmp_path / "flight.maneuvers.yaml").write_text("maneuvers: []\n")
    assert len({*keys, task.key}) == 4


def test_a_result_that_was_damaged_is_made_again(tmp_path: Path) -> None:
    (tmp_path / "half.json").write_text('{"log": "a.tl')
    assert kept(tmp_path / "half.json") is None
    assert kept(tmp_path / "none.json") is None


@pytest.mark.usefixtures("in_this_process")
def test_a_map_gives_each_log_its_aircraft_and_lists_logs_without_one(folder, advisor, tmp_path):
    (tmp_path / "known.yaml").write_text("elevator: {lag_s: 0.02}\n")
    (tmp_path / "fleet.yaml").write_text('"flight-12*": known.yaml\n')
    run = advisor(
        "batch", folder, "-o", tmp_path / "out", "--aircraft-map", tmp_path / "fleet.yaml", "--workers", 1
    )
    assert run.returncode == 0
    assert f"{folder / 'flight-11.tlog'} matches no pattern" in run.stderr
    rows = pq.read_table(tmp_path / "out" / "flights.parquet").to_pylist()
    assert {Path(row["log"]).name: row["aircraft"] for row in rows if row["usable"]} == {
        "flight-12.tlog": "known.yaml ardupilot system 1"
    }


@pytest.mark.usefixtures("in_this_process")
def test_a_wrong_file_of_marks_is_the_failure_of_its_log_alone(folder, advisor, tmp_path):
    (folder / "flight-11.maneuvers.yaml").write_text("wings: 2\n")
    run = advisor("batch", folder / "flight-11.tlog", folder / "flight-12.tlog", "-o", tmp_path / "out")
    assert run.returncode == 0
    assert "wings: unknown key" in run.stderr
    assert "logs that cannot be used: 1;" in run.stdout


def test_the_first_pattern_that_matches_path_or_name_counts() -> None:
    chosen = AircraftMap((("2026/*", Path("new.yaml")), ("a-*", Path("a.yaml")), ("*", Path("any.yaml"))))
    names = [chosen.file_of(Path(log)) for log in ("2026/a-1.tlog", "old/a-1.tlog", "b.bin")]
    assert names == [Path("new.yaml"), Path("a.yaml"), Path("any.yaml")]


def test_what_is_no_map_is_refused_with_an_example(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text("- a.yaml\n")
    with pytest.raises(ConfigurationError, match="one line a pattern"):
        read_map(tmp_path / "map.yaml")


def test_logs_of_a_folder_are_those_that_end_so_and_results_are_left_out(folder: Path) -> None:
    (folder / "out").mkdir()
    (folder / "out" / "cut.tlog").write_bytes(b"")
    (folder / "packed.TLOG.gz").write_bytes(b"")
    names = [log.name for log in find_logs([folder, folder / "flight-12.tlog"], folder / "out")]
    assert names == ["empty.bin", "flight-11.tlog", "flight-12.tlog", "packed.TLOG.gz", "copy.tlog"]


def test_a_folder_without_logs_is_one_sentence_and_exit_code_3(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    run = advisor("batch", tmp_path / "empty", "-o", tmp_path / "out")
    assert run.returncode == 3
    assert run.stderr.count("\n") == 1
    assert "holds no logs" in run.stderr
    with pytest.raises(UnusableInputError):
        find_logs([tmp_path / "empty"], tmp_path / "out")


@pytest.mark.usefixtures("in_this_process")
def test_when_no_log_can_be_used_the_exit_code_is_3(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(b"")
    run = advisor(
        "batch", tmp_path / "a.tlog", tmp_path / "none.tlog", "-o", tmp_path / "out", "--workers", 1
    )
    assert run.returncode == 3
    assert "There is no file" in run.stderr
    assert "a.tlog is empty" in run.stderr


def test_results_below_a_file_are_refused_in_one_sentence(folder, advisor, tmp_path):
    (tmp_path / "file").write_text("")
    run = advisor("batch", folder / "flight-11.tlog", "-o", tmp_path / "file" / "out")
    assert run.returncode == 2
    assert run.stderr.startswith("-o: ")
    assert f"lies below the file {tmp_path / 'file'}" in run.stderr


def test_each_flight_that_counts_has_a_report_that_is_written_once(tmp_path: Path) -> None:
    log, other = tmp_path / "one.tlog", tmp_path / "two.tlog"
    tasks = [BatchTask(one, Aircraft(), "", one.stem) for one in (log, other)]
    asked: list[str] = []

    def run(tasks: Sequence[BatchTask]) -> Iterator[tuple[BatchTask, str | Exception]]:
        asked.extend(task.sha256 for task in tasks)
        yield from ((task, "page" if task.log == log else ValueError("no fit")) for task in tasks)

    place = f"reports/{tasks[0].key}.html"
    for _ in range(2):
        assert write_reports(tasks, tmp_path, run) == {log: place}
    assert (tmp_path / place).read_text() == "page"
    assert asked == ["one", "two", "two"]
