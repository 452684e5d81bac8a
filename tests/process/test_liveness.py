"""A process that hangs is told of and ended; one that works, or whose watch stood still itself, is not."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from advisor.process import liveness
from advisor.process.liveness import Watch
from tests.mavlink.link.builders import wait_until


@pytest.fixture
def process() -> Iterator["subprocess.Popen[bytes]"]:
    with subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]) as process:
        yield process
        process.kill()


@pytest.fixture(autouse=True)
def short_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, seconds in (("OLD_AFTER_S", 0.1), ("ENDED_AFTER_S", 0.4), ("_LOOK_EVERY_S", 0.02)):
        monkeypatch.setattr(liveness, name, seconds)


def test_the_limits_are_those_that_the_crew_is_told_of() -> None:
    told = (Path(__file__).parents[2] / "SECURITY.md").read_text(encoding="utf-8")
    assert "the estimator hangs | after 3 s " in told
    assert "after 20 s it is ended and started again" in told


def test_a_process_that_says_no_more_is_told_of_and_then_ended(process: "subprocess.Popen[bytes]") -> None:
    told: list[float] = []
    with Watch(process, told.append, 0) as watch:
        watch.heard()
        assert process.wait(5.0) == -signal.SIGKILL
    assert 0.1 <= told[0] < 0.4
    assert watch.ended_after_s is not None
    assert watch.ended_after_s >= 0.4


def test_a_process_that_speaks_now_and_then_is_left_alone(process: "subprocess.Popen[bytes]") -> None:
    told: list[float] = []
    with Watch(process, told.append, 0) as watch:
        for _ in range(20):
            watch.heard()
            time.sleep(0.03)
    assert process.poll() is None
    assert told == []


def test_the_time_in_which_the_watch_stood_still_makes_nobody_late(process, monkeypatch):
    leap = [0.0]
    monkeypatch.setattr(liveness, "monotonic", lambda: time.monotonic() + leap[0])
    told: list[float] = []
    with Watch(process, told.append, 0) as watch:
        watch.heard()
        leap[0] = 3600.0
        time.sleep(0.05)
        watch.heard()
        time.sleep(0.05)
    assert process.poll() is None
    assert told == []


def test_a_computer_that_needs_longer_gets_twice_the_time_after_each_end(process):
    with Watch(process, lambda age_s: None, 2) as watch:
        watch.heard()
        assert process.wait(10.0) == -signal.SIGKILL
    assert watch.ended_after_s is not None
    assert watch.ended_after_s >= 1.6


def test_a_source_that_cannot_be_read_again_is_never_ended_unless_the_user_leaves(process):
    told: list[float] = []
    with Watch(process, told.append, None) as watch:
        watch.heard()
        wait_until(lambda: bool(told) and told[-1] > 0.6)
        assert process.poll() is None
        watch.hurry()
        assert process.wait(5.0) == -signal.SIGKILL
