"""Jobs in a thread of their own, so that no estimate delays the next sample of a stream."""

from collections import deque
from collections.abc import Callable
from threading import Thread
from time import monotonic
from typing import Generic, TypeVar

Made = TypeVar("Made")


class Aside(Generic[Made]):
    """Does jobs one after another, in their order.

    Parameters
    ----------
    in_thread
        Whether another thread does the jobs. If false, each job is done before ``do`` returns.
    """

    def __init__(self, in_thread: bool) -> None:
        self.in_thread = in_thread
        self._made: deque[Made] = deque()
        self._newest: Thread | None = None
        self._failure: BaseException | None = None
        self._begun_s: float | None = None

    @property
    def age_s(self) -> float:
        """Time since the begin of the present job, s; 0 without a job."""
        begun_s = self._begun_s
        return 0.0 if begun_s is None else monotonic() - begun_s

    @property
    def is_busy(self) -> bool:
        """Whether a job is waiting or being done."""
        return self._newest is not None and self._newest.is_alive()

    @property
    def is_pending(self) -> bool:
        """Whether a job is not done, or its result is not fetched."""
        return self.is_busy or bool(self._made) or self._failure is not None

    def do(self, job: Callable[[], Made]) -> None:
        """Do a job after all earlier ones."""
        if not self.in_thread:
            self._made.append(job())
            return
        # A daemon: nobody who leaves waits for an estimate.
        self._newest = Thread(target=self._work, args=(job, self._newest), daemon=True)
        self._newest.start()

    def wait(self) -> None:
        """Return when every job is done."""
        if self._newest is not None:
            self._newest.join()

    def made(self) -> list[Made]:
        """Return the results since the last call, in the order of the jobs.

        Raises
        ------
        BaseException
            The error of a job. Later jobs are not done.
        """
        if self._failure is not None:
            raise self._failure
        return [self._made.popleft() for _ in range(len(self._made))]

    def _work(self, job: Callable[[], Made], before: Thread | None) -> None:
        if before is not None:
            before.join()
        if self._failure is not None:
            return
        self._begun_s = monotonic()
        try:
            self._made.append(job())
        except BaseException as failure:
            self._failure = failure
        finally:
            self._begun_s = None
