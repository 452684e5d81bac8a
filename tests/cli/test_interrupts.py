"""Ctrl-C ends the program in one sentence; a recording is whole whatever signal ends it."""

import os
import random
import signal
import subprocess
import sys
import time
from math import inf
from pathlib import Path

import pytest

from advisor.mavlink.logs.formats.telemetry import read_tlog
from advisor.process.interrupt import in_order
from tests.cli.processes import flight, start
from tests.mavlink.link.builders import free_port, wait_until

_STARTS_S = 0.15
"""Until then the interpreter itself starts, whose tracebacks no program can prevent, s of processor time."""
_COMMANDS: dict[str, list[object]] = {
    "analyze": ["analyze"],
    "gap": ["gap", "--out", "/dev/null"],
    "replay": ["replay"],
    "study": ["study", "--campaigns", "2000"],
    "demo": ["demo"],
}

FAILING_IMPORT = """
import signal
from advisor.process.interrupt import Interrupted, in_order
try:
    with in_order():
        try:
            signal.raise_signal(signal.SIGINT)
        except Interrupted:
            raise ImportError("initialization failed")
except Interrupted as end:
    print(end, "after", repr(str(end.__cause__)))
"""
"""A program in which a library turns the signal into an error of its own."""


SIGNALLED = """
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)
from advisor.cli import group
from advisor.start import main
command = group.main
def signalled():
    signal.raise_signal(signal.SIGINT)
    command()
group.main = signalled
main()
"""
"""A program that was started with Ctrl-C ignored, and hears one before its command."""


def hears_interrupts(pid: int) -> bool:
    """Whether the interpreter has come so far that a signal no longer ends it unheard (Linux, proc(5))."""
    status = Path(f"/proc/{pid}/status")
    if not status.exists():
        return True
    caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt"))
    return bool(int(caught.split()[1], 16) & 1 << (signal.SIGINT - 1))


def worked_s(pid: int) -> float:
    """Processor time that a process has had, s (Linux, proc(5)); infinite where it has ended."""
    stat = Path(f"/proc/{pid}/stat")
    if not stat.exists():
        return inf
    user, system = stat.read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize("times", [1, pytest.param(10, marks=pytest.mark.study)])
@pytest.mark.parametrize("command", _COMMANDS)
def test_ctrl_c_at_a_random_moment_ends_in_one_sentence(command: str, times: int) -> None:
    arguments = _COMMANDS[command] + ([flight()] if command in ("analyze", "gap", "replay") else [])
    for _ in range(times):
        with start(*arguments) as process:
            wait_until(lambda: hears_interrupts(process.pid) and worked_s(process.pid) > _STARTS_S)
            time.sleep(random.uniform(0.0, 2.0))
            if process.poll() is not None:
                continue
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=20)
        assert process.returncode in (130, 0), err  # 0: the command was about to end
        if process.returncode == 130:  # before its end ``gap`` may have said what became of its file
            told = [line for line in err.splitlines() if not line.startswith(b"/dev/null ")]
            assert told == [b"Stopped."]


@pytest.mark.parametrize(
    ("number", "code"), [pytest.param(signal.SIGINT, 130, marks=pytest.mark.study), (signal.SIGTERM, 143)]
)
def test_a_signal_leaves_a_whole_recording_and_says_where(number, code, tmp_path):
    port, recording = free_port(), tmp_path / "flight.tlog"
    fly = [sys.executable, "-m", "sim", "fly", "--master", f"udpout:127.0.0.1:{port}"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with (
        start("live", "--master", f"udpin:127.0.0.1:{port}", "--record", recording) as live,
        subprocess.Popen(fly, **quiet) as sim,
    ):
        try:
            wait_until(lambda: recording.exists() and recording.stat().st_size > 5000, timeout_s=30.0)
            live.send_signal(number)
            _, err = live.communicate(timeout=20)
        finally:
            sim.kill()
            live.kill()
    assert live.returncode == code
    assert err.decode().splitlines()[-1] == f"Stopped; the recording is {recording}."
    assert b"Traceback" not in err
    records = recording.read_bytes()
    at = 0
    while at < len(records):
        at += 8 + 12 + records[at + 9]
    assert at == len(records)
    assert sum(len(columns) for batch in read_tlog(recording) for columns in batch) > 100


def test_a_signal_that_the_shell_ignores_stays_ignored() -> None:
    command = [sys.executable, "-c", SIGNALLED, "locate"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0
    assert "config" in run.stdout


def test_an_import_that_fails_because_of_a_signal_is_an_interrupt() -> None:
    run = subprocess.run([sys.executable, "-c", FAILING_IMPORT], capture_output=True, text=True, timeout=60)
    assert run.stdout == "Stopped. after 'initialization failed'\n", run.stderr


def test_an_error_without_a_signal_stays_this_error() -> None:
    with pytest.raises(ImportError, match="no such library"), in_order():
        raise ImportError("no such library")
