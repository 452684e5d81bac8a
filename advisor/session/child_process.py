"""Child processes of a screen: their start, their messages, and the sentences on their end."""

import os
import pickle
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from subprocess import DEVNULL, PIPE, Popen
from typing import IO

from advisor.process import interrupt
from advisor.process.children import python_module
from advisor.process.liveness import Watch

_LONGEST_PAUSE_S = 10.0


def start_child(module: str, shows_errors: bool = False) -> "Popen[bytes]":
    """Start a module of the advisor as a process that exchanges pickles over its standard streams.

    Parameters
    ----------
    module
        Name of the module for ``python -m``.
    """
    return Popen(python_module(module), stdin=PIPE, stdout=PIPE, stderr=None if shows_errors else DEVNULL)


@contextmanager
def messages_to_parent() -> Iterator[IO[bytes]]:
    """Yield the pipe of messages to the parent of this process. An error is the last message."""
    interrupt.ignore()  # a signal is for the parent, which then ends this process in order
    # Closed at the end, after which the other side closes the requests.
    with suppress(BrokenPipeError), os.fdopen(os.dup(sys.stdout.fileno()), "wb") as messages:
        # A library's output must not fall among the messages.
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        try:
            yield messages
        except Exception as failure:
            failure.add_note(traceback.format_exc())
            send(messages, failure)


def send(pipe: IO[bytes], message: object) -> None:
    """Write a message immediately."""
    pickle.dump(message, pipe, pickle.HIGHEST_PROTOCOL)
    pipe.flush()


def said_of(code: int, watch: Watch) -> str:
    """Return a clause on the end of a process, from the exit code and the watch."""
    if watch.ended_after_s is not None:
        return f"did not answer for {watch.ended_after_s:.0f} s and was ended"
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"


def pause_s(deaths: int) -> float:
    """Return the pause before a process is restarted, s: zero at first, a second more after each death."""
    return min(deaths - 1.0, _LONGEST_PAUSE_S)
