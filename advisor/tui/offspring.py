"""Starting the processes that work for a face, and saying how they ended."""

import signal
import sys
from subprocess import DEVNULL, PIPE, Popen

_LONGEST_PAUSE_S = 10.0


def offspring(module: str, shows_errors: bool = False) -> "Popen[bytes]":
    """Start a module of the advisor as a process that is spoken to by pickles on its standard streams.

    Parameters
    ----------
    module
        Name of the module, as ``python -m`` takes it.
    shows_errors
        Whether the process writes to the standard error of this one.
    """
    return Popen(
        [sys.executable, "-m", module], stdin=PIPE, stdout=PIPE, stderr=None if shows_errors else DEVNULL
    )


def said_of(code: int) -> str:
    """How a process has ended, from its exit code."""
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"


def pause_s(deaths: int) -> float:
    """Seconds to wait before a process is started again: none at first, a second more after each death."""
    return min(deaths - 1.0, _LONGEST_PAUSE_S)
