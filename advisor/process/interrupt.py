"""Ctrl-C and other signals: the program ends with one sentence, at once or in order.

An exception that a signal raises is printed and lost where a library calls back from C. Outside the advisor's
own code the exception leaves a traceback. So Ctrl-C ends the process itself. While a recording or a screen is
open, a signal raises :class:`Interrupted` instead, which closes both.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_PATIENCE_S = 5.0
"""Longest time for an orderly end, s. A recording is closed within 0.5 s. The limit is needed because an
exception may be lost."""
STOPPED = "Stopped."
"""Sentence for the user where nothing else is to be said."""
_KINDS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)  # Windows has no SIGHUP


class Interrupted(KeyboardInterrupt):
    """A signal has ended the work in order; ``str`` gives the sentence for the user."""

    def __init__(self, sentence: str, code: int) -> None:
        super().__init__(sentence)
        self.code = code
        """Exit code: 128 plus the signal's number, which is the shell's convention."""


def hung_up(error: BaseException | None) -> bool:
    """Return whether the terminal went away: its window was closed, or its network connection was lost."""
    hang_up = getattr(signal, "SIGHUP", None)
    return isinstance(error, Interrupted) and hang_up is not None and error.code == 128 + hang_up


def end_at_once() -> None:
    """Let Ctrl-C end the process with one sentence and exit code 130, at any later moment."""
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _end_process)


@contextmanager
def in_order(sentence: Callable[[], str] = lambda: STOPPED) -> Iterator[None]:
    """Let Ctrl-C, SIGTERM and SIGHUP raise :class:`Interrupted` within the block, once.

    An ignored signal, as under ``nohup``, stays ignored.

    Parameters
    ----------
    sentence
        Gives the sentence for the user when a signal comes.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        for kind in heard:
            signal.signal(kind, signal.SIG_IGN)
        said, code = sentence(), 128 + number
        _end_later(said, code)
        sys.unraisablehook = _write_unless_interrupted
        raised.append(Interrupted(said, code))
        raise raised[0]

    raised: list[Interrupted] = []
    hook = sys.unraisablehook
    heard = [kind for kind in _KINDS if signal.getsignal(kind) is not signal.SIG_IGN]
    if threading.current_thread() is not threading.main_thread():
        heard = []
    before = [signal.signal(kind, interrupt) for kind in heard]
    try:
        yield
    except Exception as error:
        if raised:  # a library that was being imported answers the signal with an error of its own
            raise raised[0] from error
        raise
    finally:
        sys.unraisablehook = hook
        for kind, handler in zip(heard, before, strict=True):
            signal.signal(kind, handler)


def ignore() -> None:
    """Ignore every signal; another process receives the signal and ends this process in order."""
    for kind in _KINDS:
        signal.signal(kind, signal.SIG_IGN)


def _end_process(number: int, frame: FrameType | None) -> None:
    _say_and_exit(STOPPED, 128 + number)


def _write_unless_interrupted(lost: "sys.UnraisableHookArgs") -> None:
    """Write an exception that a callback from C has lost, unless a signal raised the exception."""
    if not isinstance(lost.exc_value, Interrupted):
        sys.__unraisablehook__(lost)


def _end_later(sentence: str, code: int) -> None:
    """End the process when the orderly end takes too long or the exception is lost."""
    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, lambda number, frame: _say_and_exit(sentence, code))
        signal.setitimer(signal.ITIMER_REAL, _PATIENCE_S)


def _say_and_exit(sentence: str, code: int) -> None:
    from advisor.words.ascii_output import plain

    with suppress(OSError):
        # On a terminal a progress bar may stand in this line and may have hidden the cursor.
        begin = "\n\033[?25h" if os.isatty(2) else ""
        os.write(2, f"{begin}{plain(sentence)}\n".encode())
    os._exit(code)
