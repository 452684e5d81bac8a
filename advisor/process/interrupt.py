"""Handling of Ctrl-C and other signals. The program ends with one sentence, immediately or after closing its
files.

A signal's exception is printed and lost if a library is calling back from C. Outside the advisor's own code
the exception prints a traceback. Ctrl-C ends the process. While a recording or a screen is open, a signal
raises :class:`Interrupted` instead, which closes both. A busy computer may take long for that. A second
Ctrl-C ends the process at once.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_LOST_AFTER_S = 1.0
"""Time after which an exception without a handler is considered lost, s. A lost exception is raised again."""
_ONE_PRESS_S = 0.3
"""Longest time between two signals of one Ctrl-C, s: ``timeout`` signals a program and then its process
group. No user presses the keys twice within this time."""
STOPPED = "Stopped."
"""Sentence for the user if there is nothing else to report."""
_KINDS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)  # Windows has no SIGHUP


class Interrupted(KeyboardInterrupt):
    """A signal has ended the work after closing its files; ``str`` returns the sentence for the user."""

    def __init__(self, sentence: str, code: int) -> None:
        super().__init__(sentence)
        self.code = code
        """Exit code: 128 plus the signal's number, which is the shell's convention."""


def hung_up(error: BaseException | None) -> bool:
    """Return whether the terminal has disappeared: its window was closed, or its network connection was
    lost."""
    hang_up = getattr(signal, "SIGHUP", None)
    return isinstance(error, Interrupted) and hang_up is not None and error.code == 128 + hang_up


def end_at_once() -> None:
    """Let Ctrl-C end the process with one sentence and exit code 130, after this call."""
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _end_process)


@contextmanager
def in_order(sentence: Callable[[], str] = lambda: STOPPED) -> Iterator[None]:
    """Let Ctrl-C, SIGTERM and SIGHUP raise :class:`Interrupted` within the block, once.

    An ignored signal, as under ``nohup``, stays ignored. A block within another block has no further effect.
    """
    before = {kind: signal.getsignal(kind) for kind in _KINDS}
    heard = [kind for kind, handler in before.items() if handler is not signal.SIG_IGN]
    nested = any(isinstance(handler, _OrderlyEnd) for handler in before.values())
    if nested or threading.current_thread() is not threading.main_thread():
        yield
        return
    end, hook = _OrderlyEnd(sentence), sys.unraisablehook
    for kind in heard:
        signal.signal(kind, end)
    try:
        yield
    except Exception as error:
        if end.raised:  # a library that was being imported answers the signal with an error of its own
            raise end.raised from error
        raise
    else:
        if end.raised:  # a library has kept the exception to itself
            raise end.raised
    finally:
        end.settle()
        sys.unraisablehook = hook
        for kind in heard:
            signal.signal(kind, before[kind])


class _OrderlyEnd:
    """Handler: raises :class:`Interrupted` at the first signal, ends the process at a second Ctrl-C."""

    def __init__(self, sentence: Callable[[], str]) -> None:
        self._sentence = sentence
        self.raised: Interrupted | None = None
        """The exception that was raised at the first signal."""
        self._since_s = 0.0

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.raised is None:
            self.raised = Interrupted(self._sentence(), 128 + number)
            self._since_s = time.monotonic()
            sys.unraisablehook = _write_unless_interrupted
            if hasattr(signal, "SIGALRM"):
                self._alarm = signal.signal(signal.SIGALRM, self._raise_if_lost)
                signal.setitimer(signal.ITIMER_REAL, _LOST_AFTER_S, _LOST_AFTER_S)
            raise self.raised
        if number == signal.SIGINT and time.monotonic() - self._since_s > _ONE_PRESS_S:
            _say_and_exit(str(self.raised), self.raised.code)

    def settle(self) -> None:
        """Stop the timer that checks for a lost exception. A timer signal after the end of Python's signal
        handlers would kill the process."""
        if self.raised is not None and hasattr(signal, "SIGALRM"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, self._alarm)

    def _raise_if_lost(self, number: int, frame: FrameType | None) -> None:
        """Raise the exception again, unless contexts are being closed because of it."""
        handled = sys.exception()
        while handled is not None and handled is not self.raised:
            handled = handled.__context__
        if handled is None and self.raised is not None:
            raise self.raised


def ignore() -> None:
    """Ignore every signal; another process receives the signal and ends this process."""
    for kind in _KINDS:
        signal.signal(kind, signal.SIG_IGN)


def _end_process(number: int, frame: FrameType | None) -> None:
    _say_and_exit(STOPPED, 128 + number)


def _write_unless_interrupted(lost: "sys.UnraisableHookArgs") -> None:
    """Print an exception that a callback from C has lost, unless a signal raised the exception."""
    if not isinstance(lost.exc_value, Interrupted):
        sys.__unraisablehook__(lost)


def _say_and_exit(sentence: str, code: int) -> None:
    from advisor.words.problems import plain

    with suppress(OSError):
        # On a terminal a progress bar may stand in this line and may have hidden the cursor.
        begin = "\n\033[?25h" if os.isatty(2) else ""
        os.write(2, f"{begin}{plain(sentence)}\n".encode())
    os._exit(code)
