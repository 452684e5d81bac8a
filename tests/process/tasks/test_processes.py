"""Tasks in processes: each is done once, a dead worker costs its own task, no worker outlives the program."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path

from advisor.process.children import spawning
from advisor.process.interrupt import ignore
from advisor.process.tasks.processes import run_in_processes
from tests.mavlink.link.builders import wait_until


def square(number: int) -> int:
    if number == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 7:
        raise ValueError("seven")
    return number * number


def say_who_and_sleep(file: str) -> None:
    Path(file).write_text(str(os.getpid()))
    time.sleep(60.0)


def test_every_task_is_done_once_and_an_error_belongs_to_its_task() -> None:
    done = dict(run_in_processes(square, [1, 7, 3], workers=2))
    assert (done[1], done[3]) == (1, 9)
    assert isinstance(done[7], ValueError)


def test_a_worker_that_is_killed_costs_its_own_task_only() -> None:
    told = list(run_in_processes(square, [1, 2, 13, 4, 5, 6], workers=2))
    done = dict(told)
    assert len(told) == 6
    assert {n: done[n] for n in (1, 2, 4, 5, 6)} == {1: 1, 2: 4, 4: 16, 5: 25, 6: 36}
    assert isinstance(done[13], BrokenExecutor)


def leave_signals_and_sleep(file: str) -> None:
    ignore()
    say_who_and_sleep(file)


def test_a_child_that_leaves_signals_to_its_parent_can_be_ended(tmp_path: Path) -> None:
    child = spawning().Process(target=leave_signals_and_sleep, args=(str(tmp_path / "pid"),))
    child.start()
    wait_until((tmp_path / "pid").exists, 30.0)
    child.terminate()
    child.join(10.0)
    assert child.exitcode == -signal.SIGKILL


def test_without_tasks_no_process_is_started() -> None:
    assert list(run_in_processes(square, [], workers=2)) == []


def is_alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits to be reaped does not."""
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"


def test_workers_end_when_the_program_is_killed(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    program = (
        "from advisor.process.tasks.processes import run_in_processes\n"
        "from tests.process.tasks.test_processes import say_who_and_sleep\n"
        f"if __name__ == '__main__': list(run_in_processes(say_who_and_sleep, [{str(file)!r}], 1))\n"
    )
    script = tmp_path / "program.py"
    script.write_text(program)
    run = subprocess.Popen([sys.executable, str(script)], env={**os.environ, "PYTHONPATH": os.getcwd()})
    until = time.monotonic() + 60.0
    while not (file.exists() and file.read_text()) and time.monotonic() < until:
        time.sleep(0.05)
    worker = int(file.read_text())
    assert is_alive(worker)
    run.kill()
    run.wait()
    while is_alive(worker) and time.monotonic() < until:
        time.sleep(0.05)
    assert not is_alive(worker)


def test_one_thread_of_linear_algebra_is_set_before_numpy_reads_their_number():
    loaded = list(sys.modules)
    assert loaded.index("advisor.process.tasks.pinned") < loaded.index("numpy")
