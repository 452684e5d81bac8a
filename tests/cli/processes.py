"""The command as a program of its own, as a terminal starts it."""

import os
import signal
import subprocess
import sys
from pathlib import Path

from tests.flights import TWO, recorded


def flight() -> Path:
    """A short log of two manoeuvres."""
    return recorded("uav", 1.0, maneuvers=TWO)


def start(*arguments: object, **environment: str) -> "subprocess.Popen[bytes]":
    """The command without a screen, its output in pipes."""
    return subprocess.Popen(
        [sys.executable, "-m", "advisor", *map(str, arguments)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "HEADLESS": "1", **environment},
        preexec_fn=_as_in_a_terminal,
    )


def _as_in_a_terminal() -> None:
    """Hear the signals that a shell lets its background jobs ignore, and these tests with them."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def finished(*arguments: object, **environment: str) -> tuple[int, bytes, bytes]:
    """Exit code and both outputs of a command that ends by itself."""
    with start(*arguments, **environment) as process:
        out, err = process.communicate(timeout=60)
    return process.returncode, out, err
