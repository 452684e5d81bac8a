"""Liveness of another process that works for this process, measured by the age of its messages.

A process can hang without ending: stopped, swapped out, waiting for a disk, or in an endless loop. No
exception reports a process that hangs. The supervisor therefore measures the age of the newest message.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, nan
from subprocess import Popen
from threading import Event, Thread
from time import monotonic
from typing import Self

OLD_AFTER_S = 3.0
"""Age of the newest report, s, above which the crew is informed that the report is old. Reports come every
0.1 s; a joint estimate of seven manoeuvres delays one by up to 2 s on a laptop."""
ENDED_AFTER_S = 20.0
"""Age of the newest report, s, above which a process is ended and started again. The longest estimate in
flight takes a tenth of this time. The limit doubles with each restart, so that a slow computer can finish."""
START_S = 60.0
"""Longest time to a process's first report, s. A process without a report by then is ended. Libraries load
within 10 s, and functions without stored machine code are compiled within this time. A patient watch waits
equally long for a report.
"""
_LOOK_EVERY_S = 0.5


@dataclass(frozen=True, slots=True)
class Beat:
    """Message of a process that has nothing else to report."""

    busy: bool
    """Whether the process is reading the earlier recording, which may take long."""
    behind_s: float = 0.0
    """Backlog of the process, as the process itself estimates it, s."""
    read_to_s: float = nan
    """Host time of the newest record that the process received, seconds since 1970."""


class Watch:
    """Measures the age of a process's newest message while the context is open.

    An interval between two checks is limited to twice its planned length. While this process was stopped or
    the computer slept, the other process was not late.

    Parameters
    ----------
    tell
        Function that receives the message's age, s, at every check at which the newest message is old. The
        calls come from a thread of the watch.
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
        """Age of the newest message, s, at which the process was ended. None: the watch has not ended the
        process."""

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        self._thread.join()

    def heard(self, patient: bool = False) -> None:
        """Record the arrival of a message.

        Parameters
        ----------
        patient
            Whether the process is reading the earlier recording, which may take long.
        """
        self._limit_s = START_S if patient else ENDED_AFTER_S
        self._messages += 1

    def rest(self) -> None:
        """End the watch while the process waits for requests."""
        self._over.set()

    def hurry(self) -> None:
        """End the process if it does not end by itself within ``OLD_AFTER_S``."""
        self._hurries = True

    def _run(self) -> None:
        counted, silent_s, looked_s = self._messages, 0.0, monotonic()
        while not self._over.wait(_LOOK_EVERY_S):
            before_s, looked_s = looked_s, monotonic()
            silent_s += min(looked_s - before_s, 2.0 * _LOOK_EVERY_S)
            if self._messages != counted:
                counted, silent_s = self._messages, 0.0
            if silent_s >= self._end_s:
                self.ended_after_s = silent_s
                self._process.kill()
                return
            if silent_s >= OLD_AFTER_S and self._messages:
                self._tell(silent_s)

    @property
    def _end_s(self) -> float:
        """Age of the newest message at which the watched process is ended, s."""
        if self._hurries:
            return OLD_AFTER_S
        return inf if self._slower is None else self._limit_s * self._slower
