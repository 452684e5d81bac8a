"""``advisor batch --scheduler``: a Dask cluster gives what one process gives, and loses nothing."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from advisor.aircraft.aircraft import Aircraft
from advisor.batch.flight import BatchTask, analyze_shared, sha256_of
from advisor.process.tasks.cluster import (
    _connected,
    _named,
    _pinned,
    _versions_on,
    compare_versions,
    run_on_cluster,
)
from advisor.words.problems import ConfigurationError
from tests.batch.test_command import folder as folder
from tests.batch.test_command import in_this_process as in_this_process
from tests.conftest import Advisor

if TYPE_CHECKING:
    from distributed import LocalCluster

SAME = {"advisor": "1.0", "python": "3.11.2.final.0", "numpy": "2.1"}

TWO_SLEEPS = """
import sys, time
from advisor.process.tasks.cluster import run_on_cluster
from advisor.words.problems import ConfigurationError
try:
    for _ in run_on_cluster(time.sleep, [0.0, 60.0], sys.argv[1], print):
        print("done", flush=True)
except ConfigurationError as error:
    print(error, file=sys.stderr)
"""
"""A program that does two tasks and says when the first is done."""


def started(workers: int, processes: bool = False) -> "LocalCluster":
    """A cluster on loopback, at ports that the system chooses; a task may kill two workers of its own.

    Workers are threads, whose start takes no seconds, where nothing asks for processes.
    """
    import dask
    from distributed import LocalCluster

    with dask.config.set({"distributed.scheduler.allowed-failures": 1}):
        return LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=processes,
            protocol="tcp",
            host="127.0.0.1",
            scheduler_port=0,
            dashboard_address="127.0.0.1:0",
            worker_dashboard_address="127.0.0.1:0",
        )


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    with started(workers=1) as cluster:
        yield cluster.scheduler_address


@pytest.fixture(scope="module")
def other_process() -> Iterator[str]:
    """The scheduler of a worker that is a process."""
    with started(workers=1, processes=True) as cluster:
        yield cluster.scheduler_address


def die_the_first_time(mark: Path) -> str:
    if "first" in mark.name and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return mark.name


def die_always(number: int) -> int:
    if number == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def threads_of_linear_algebra(_: int) -> list[int]:
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


def sleep(seconds: float) -> None:
    time.sleep(seconds)


def tables(out: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in out.glob("*.parquet")}


@pytest.mark.usefixtures("in_this_process")
def test_a_cluster_gives_the_tables_of_one_process_and_a_second_run_does_nothing(
    scheduler: str, folder: Path, advisor: Advisor, tmp_path: Path
) -> None:
    alone, shared = tmp_path / "alone", tmp_path / "shared"
    advisor("batch", folder, "-o", alone, "--workers", 1)
    first = advisor("batch", folder, "-o", shared, "--scheduler", scheduler)
    assert first.returncode == 0, first.stderr
    assert len(tables(alone)) == 3
    assert tables(shared) == tables(alone)
    stamps = {path: path.stat().st_mtime_ns for path in (shared / "flights").iterdir()}
    second = advisor("batch", folder, "-o", shared, "--scheduler", scheduler)
    assert "3 of 3 logs were analyzed before." in second.stderr
    assert "a minute" not in second.stderr
    assert {path: path.stat().st_mtime_ns for path in (shared / "flights").iterdir()} == stamps


@pytest.mark.study
def test_a_cluster_gives_the_study_of_one_process(other_process: str, advisor: Advisor) -> None:
    words = ("study", "--campaigns", 10, "--json")
    shared = advisor(*words, "--scheduler", other_process)
    assert shared.returncode == 0, shared.stderr
    assert shared.stdout == advisor(*words, "--workers", 1).stdout


@pytest.mark.study
def test_a_worker_that_is_killed_in_the_middle_loses_nothing(other_process: str, tmp_path: Path) -> None:
    marks = [tmp_path / name for name in ("a", "b", "first", "c", "d")]
    done = dict(run_on_cluster(die_the_first_time, marks, other_process, pytest.fail))
    assert (tmp_path / "first").exists()
    assert done == {mark: mark.name for mark in marks}


@pytest.mark.study
def test_a_task_that_kills_every_worker_costs_itself_only(other_process: str) -> None:
    done = dict(run_on_cluster(die_always, [1, 13, 2], other_process, pytest.fail))
    assert isinstance(done.pop(13), BrokenExecutor)
    assert done == {1: 1, 2: 4}


@pytest.mark.study
def test_linear_algebra_in_a_worker_has_one_thread(other_process: str) -> None:
    ((_, threads),) = run_on_cluster(threads_of_linear_algebra, [0], other_process, pytest.fail)
    assert isinstance(threads, list)
    assert set(threads) == {1}


def test_a_task_has_one_thread_for_linear_algebra() -> None:
    with threadpool_limits(2):
        threads = _pinned(threads_of_linear_algebra, 0)
    assert set(threads) == {1}


def test_a_scheduler_that_ends_in_the_middle_is_told_in_one_sentence() -> None:
    with started(workers=1) as cluster:
        words = [sys.executable, "-c", TWO_SLEEPS, cluster.scheduler_address]
        run = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert run.stdout is not None
        assert run.stdout.readline() == "done\n"
    _, told = run.communicate(timeout=60.0)
    assert told.count("\n") == 1, told
    assert "is lost. Repeat the command" in told


@pytest.mark.parametrize("address", ["8786", "host:8786", "http://host:8786", "tcp://host", "tcp://[:1"])
def test_what_is_no_address_is_refused_with_an_example(address, folder, advisor, tmp_path):
    run = advisor("batch", folder, "-o", tmp_path / "out", "--scheduler", address)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert "give one as tcp://host:8786" in run.stderr


@pytest.mark.parametrize("listening", [False, True])
def test_an_address_without_a_scheduler_is_told_within_seconds(listening, folder, advisor, tmp_path):
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        if listening:
            place.listen()
        began = time.monotonic()
        address = f"tcp://127.0.0.1:{place.getsockname()[1]}"
        run = advisor("batch", folder / "flight-11.tlog", "-o", tmp_path / "out", "--scheduler", address)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1), run.stderr
    assert f"no Dask scheduler answers at {address}" in run.stderr
    assert time.monotonic() - began < 20.0


def test_a_cluster_without_workers_is_told() -> None:
    with (
        started(workers=0) as cluster,
        pytest.raises(ConfigurationError, match="has no workers; start some with 'dask worker tcp://"),
    ):
        list(run_on_cluster(sleep, [0.0], cluster.scheduler_address, pytest.fail))


def test_without_dask_the_extra_is_named(folder, advisor, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    run = advisor("batch", folder, "-o", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:1")
    assert run.returncode == 2
    assert run.stderr == "--scheduler needs Dask: pip install 'inflight-advisor[cluster]'.\n"


def test_processes_here_and_a_cluster_exclude_each_other(folder, advisor, tmp_path):
    run = advisor("batch", folder, "-o", tmp_path, "--workers", 1, "--scheduler", "tcp://127.0.0.1:1")
    assert run.returncode == 2
    assert "not both" in run.stderr


@pytest.mark.parametrize(
    ("there", "told"),
    [
        ({"advisor": "0.9"}, "there is advisor 0.9 on tcp://b:1, 1.0 here."),
        ({"advisor": None}, "there is no advisor on tcp://b:1."),
        ({"python": "3.12.1.final.0"}, "there is python 3.12 on tcp://b:1, 3.11 here."),
    ],
)
def test_workers_of_another_advisor_or_python_are_refused(there: dict[str, str | None], told: str) -> None:
    with pytest.raises(ConfigurationError, match=told):
        compare_versions(SAME, {"tcp://a:1": SAME, "tcp://b:1": {**SAME, **there}})


def test_the_versions_of_advisor_and_python_on_a_worker_are_known(scheduler: str) -> None:
    with _connected(scheduler) as client:
        found = _versions_on(client)
    for packages in (
        found["client"]["packages"],
        *(there["packages"] for there in found["workers"].values()),
    ):
        known = _named(packages)
        assert known["python"] == ".".join(map(str, sys.version_info))
        assert known["advisor"]


def test_workers_without_a_known_version_are_refused() -> None:
    nothing = {"advisor": None, "python": None}
    with pytest.raises(ConfigurationError, match="there is no advisor on tcp://a:1; no python on tcp://a:1"):
        compare_versions(nothing, {"tcp://a:1": nothing})


def test_workers_of_another_numpy_are_told_with_their_version() -> None:
    caution = compare_versions(SAME, {"tcp://a:1": {**SAME, "numpy": "2.0", "python": "3.11.9.final.0"}})
    assert caution == "Results may differ in the last digits: numpy 2.0 on tcp://a:1, 2.1 here."
    assert compare_versions(SAME, {"tcp://a:1": SAME}) == ""


def test_a_worker_that_sees_another_log_refuses_to_analyze_one(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    log.write_bytes(b"a log")
    task = BatchTask(log, Aircraft(), "", sha256_of(log))
    log.write_bytes(b"another")
    with pytest.raises(ConfigurationError, match="sees another log there"):
        analyze_shared(task)
    log.unlink()
    with pytest.raises(ConfigurationError, match="sees no log there"):
        analyze_shared(task)
