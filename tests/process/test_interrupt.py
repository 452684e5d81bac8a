"""The end after a signal: in order however slow the computer is, at once after a second Ctrl-C.

Each program runs in a process of its own, because a signal and the alarm belong to a whole process.
"""

import subprocess
import sys
from subprocess import CompletedProcess

BEGIN = """
import signal, sys, time
from contextlib import contextmanager
from advisor.process import interrupt
from advisor.process.interrupt import Interrupted, in_order

interrupt._LOST_AFTER_S = 0.01

def ctrl_c():
    signal.raise_signal(signal.SIGINT)

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


def test_a_recording_that_closes_slowly_is_closed_in_order() -> None:
    run = program("""
try:
    with in_order(), recording():
        ctrl_c()
except Interrupted as end:
    print(end, end.code)
""")
    assert run.stdout == "closed\nStopped. 130\n", run.stderr


def test_an_error_on_the_way_does_not_cut_a_slow_end_short() -> None:
    run = program("""
def closing():
    try:
        raise OSError("the browser is gone")
    except OSError:
        time.sleep(0.1)

try:
    with in_order(), recording(closing):
        ctrl_c()
except Interrupted as end:
    print(end)
""")
    assert run.stdout == "closed\nStopped.\n", run.stderr


def test_no_alarm_is_left_to_kill_the_process_after_its_orderly_end() -> None:
    run = program("""
try:
    with in_order():
        ctrl_c()
except Interrupted:
    print(signal.getitimer(signal.ITIMER_REAL), signal.getsignal(signal.SIGALRM) is signal.SIG_DFL)
""")
    assert run.stdout == "(0.0, 0.0) True\n", run.stderr


def test_an_exception_that_a_library_swallows_is_raised_again() -> None:
    run = program("""
try:
    with in_order(), recording():
        try:
            ctrl_c()
        except BaseException:
            pass
        time.sleep(30.0)
        print("never")
except Interrupted as end:
    print(end)
""")
    assert run.stdout == "closed\nStopped.\n", run.stderr


def test_a_block_that_ends_with_a_swallowed_exception_is_interrupted() -> None:
    run = program("""
interrupt._LOST_AFTER_S = 100.0
try:
    with in_order():
        try:
            ctrl_c()
        except BaseException:
            pass
except Interrupted as end:
    print(end)
""")
    assert run.stdout == "Stopped.\n", run.stderr


def test_a_second_ctrl_c_ends_at_once() -> None:
    run = program("""
interrupt._ONE_PRESS_S = 0.0
with in_order(lambda: "Stopped; the recording is here."), recording(ctrl_c):
    ctrl_c()
""")
    assert run.returncode == 130
    assert run.stdout == ""
    assert run.stderr == "Stopped; the recording is here.\n"


def test_two_signals_of_one_key_press_count_once() -> None:
    run = program("""
interrupt._ONE_PRESS_S = 100.0
try:
    with in_order(), recording(ctrl_c):
        ctrl_c()
except Interrupted as end:
    print(end)
""")
    assert run.stdout == "closed\nStopped.\n", run.stderr


def test_the_outer_of_two_blocks_gives_the_sentence() -> None:
    run = program("""
try:
    with in_order(lambda: "The recording is here."), recording(), in_order():
        ctrl_c()
except Interrupted as end:
    print(end)
""")
    assert run.stdout == "closed\nThe recording is here.\n", run.stderr
