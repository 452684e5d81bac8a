"""The end after a signal: in order however slow the computer is, at once after a second Ctrl-C.

Each program runs in a process of its own, because a signal and the alarm belong to a whole process.
"""

import subprocess
import sys
from subprocess import CompletedProcess

from tests.rows import row

BEGIN = """
import signal, sys, time
from contextlib import contextmanager
from advisor.process import interrupt
from advisor.process.interrupt import Interrupted, in_order

interrupt._LOST_AFTER_S = 0.01

def ctrl_c():
    signal.raise_signal(signal.SIGINT)

def swallowed():
    try:
        ctrl_c()
    except BaseException:
        pass

def after_an_error():
    try:
        raise OSError("the browser is gone")
    except OSError:
        time.sleep(0.1)

@contextmanager
def recording(closing=lambda: time.sleep(0.1)):
    try:
        yield
    finally:
        closing()
        print("closed")
"""


def program(text: str) -> "CompletedProcess[str]":
    """Run a program that may use ``ctrl_c`` and a ``recording``, whose end takes ten alarms."""
    return subprocess.run([sys.executable, "-c", BEGIN + text], capture_output=True, text=True, timeout=60)


@row(
    "a recording that closes slowly is closed in order",
    "with in_order(), recording(): ctrl_c()", "closed\nStopped.",
)  # fmt: skip
@row(
    "an error on the way does not cut a slow end short",
    "with in_order(), recording(after_an_error): ctrl_c()", "closed\nStopped.",
)  # fmt: skip
@row(
    "an exception that a library swallows is raised again",
    "with in_order(), recording(): swallowed(); time.sleep(30.0); print('never')", "closed\nStopped.",
)  # fmt: skip
@row(
    "a block that ends with a swallowed exception is interrupted",
    "interrupt._LOST_AFTER_S = 100.0\n    with in_order(): swallowed()", "Stopped.",
)  # fmt: skip
@row(
    "two signals of one key press count once",
    "interrupt._ONE_PRESS_S = 100.0\n    with in_order(), recording(ctrl_c): ctrl_c()", "closed\nStopped.",
)  # fmt: skip
@row(
    "the outer of two blocks gives the sentence",
    "with in_order(lambda: 'It is here.'), recording(), in_order(): ctrl_c()", "closed\nIt is here.",
)  # fmt: skip
def test_a_block_that_is_interrupted_ends_in_order(block: str, printed: str) -> None:
    run = program(f"try:\n    {block}\nexcept Interrupted as end:\n    print(end, end.code)\n")
    assert run.stdout == f"{printed} 130\n", run.stderr


def test_no_alarm_is_left_to_kill_the_process_after_its_orderly_end() -> None:
    run = program("""
try:
    with in_order():
        ctrl_c()
except Interrupted:
    print(signal.getitimer(signal.ITIMER_REAL), signal.getsignal(signal.SIGALRM) is signal.SIG_DFL)
""")
    assert run.stdout == "(0.0, 0.0) True\n", run.stderr


def test_a_second_ctrl_c_ends_at_once() -> None:
    run = program("""
interrupt._ONE_PRESS_S = 0.0
with in_order(lambda: "Stopped; the recording is here."), recording(ctrl_c):
    ctrl_c()
""")
    assert run.returncode == 130
    assert run.stdout == ""
    assert run.stderr == "Stopped; the recording is here.\n"
