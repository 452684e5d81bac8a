"""Liveness of a process that works for this one, measured by the messages that come from it.

A process can hang without dying: stopped, swapped out, at a disk that does not answer, in a loop without an
end. No exception tells of that. The supervisor therefore measures the age of the newest message.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, nan
from subprocess import Popen
from threading import Event, Thread
from time import monotonic
from types import TracebackType
from typing import Self

OLD_AFTER_S = 3.0
"""Age of the newest report, s, above which the crew reads that it is old. Reports come every 0.1 s, and an
estimate of seven manoeuvres together delays one by up to 2 s on a laptop."""
ENDED_AFTER_S = 20.0
"""Age of the newest report, s, above which a process is ended and started again. The longest estimate in
flight takes a tenth of this. The limit doubles with each end, so that a slow computer comes to its result."""
START_S = 60.0
"""Time to the first report, s, above which a process is ended. Libraries load within 10 s, and compiled
functions that no folder keeps are compiled within this time. Patience holds as long."""
_LOOK_EVERY_S = 0.5


@dataclass(frozen=True, slots=True)
class Beat:
    """Message of a process that has nothing else to say."""

    busy: bool
    """Whether the process reads what has been recorded so far, which may take long."""
    behind_s: float = 0.0
    """Backlog of the process as it knows it, s."""
    read_to_s: float = nan
    """Host time of the newest record that the process was given, seconds since 1970."""


class Watch:
    """Measures the age of a process's newest message while the context is open.

    An interval between two looks counts at most twice its planned length. While this process was stopped
    itself, or the computer slept, nobody else was late.

    Parameters
    ----------
    process
        Process that is watched.
    tell
        Called with the age, s, at every look at which the newest message is old. The calls come from a thread
        of the watch.
    earlier_ends
        Number of processes that were ended for the same work before. None: this process is never ended.
    """

    def __init__(
        self, process: "Popen[bytes]", tell: Callable[[float], object], earlier_ends: int | None
    ) -> None:
        self._process, self._tell = process, tell
        self._slower = None if earlier_ends is None else 2.0**earlier_ends
        self._messages = 0
        self._limit_s = START_S
        self._hurries = False
        self._over = Event()
        self._thread = Thread(target=self._run, name="watch", daemon=True)
        self.ended_after_s: float | None = None
        """Age of the newest message, s, at which the process was ended. None: the process was not ended."""

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()

    def heard(self, patient: bool = False) -> None:
        """Take note of a message.

        Parameters
        ----------
        patient
            Whether the process reads what has been recorded so far, which may take long.
        """
        self._limit_s = START_S if patient else ENDED_AFTER_S
        self._messages += 1

    def rest(self) -> None:
        """Watch no longer: the process has done its work and waits for requests."""
        self._over.set()

    def hurry(self) -> None:
        """End the process where it does not end by itself within ``OLD_AFTER_S``."""
        self._hurries = True

    def _run(self) -> None:
        known, silent_s, looked_s = self._messages, 0.0, monotonic()
        while not self._over.wait(_LOOK_EVERY_S):
            before_s, looked_s = looked_s, monotonic()
            silent_s += min(looked_s - before_s, 2.0 * _LOOK_EVERY_S)
            if self._messages != known:
                known, silent_s = self._messages, 0.0
            if silent_s >= self._end_s:
                self.ended_after_s = silent_s
                self._process.kill()
                return
            if silent_s >= OLD_AFTER_S and self._messages:
                self._tell(silent_s)

    @property
    def _end_s(self) -> float:
        """Age of the newest message at which the process is ended, s."""
        if self._hurries:
            return OLD_AFTER_S
        return inf if self._slower is None else self._limit_s * self._slower
