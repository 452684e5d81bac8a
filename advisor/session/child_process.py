"""Child processes of a screen: their start, and sentences on their end."""

import signal
import sys
from subprocess import DEVNULL, PIPE, Popen

_LONGEST_PAUSE_S = 10.0


def start_child(module: str, shows_errors: bool = False) -> "Popen[bytes]":
    """Start a module of the advisor as a process that exchanges pickles over its standard streams.

    Parameters
    ----------
    module
        Name of the module for ``python -m``.
    shows_errors
        Whether the process shares this process's standard error.
    """
    return Popen(
        [sys.executable, "-m", module], stdin=PIPE, stdout=PIPE, stderr=None if shows_errors else DEVNULL
    )


def said_of(code: int) -> str:
    """Return a clause on the end of a process, from its exit code."""
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"


def pause_s(deaths: int) -> float:
    """Return the pause before a process is restarted, s: none at first, a second more after each death."""
    return min(deaths - 1.0, _LONGEST_PAUSE_S)
