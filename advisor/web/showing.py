"""A running campaign and its newest report, for any number of pages."""

from threading import Condition, Thread
from types import TracebackType
from typing import Self

from advisor.session.conducting import Conducting, SessionReport

PATIENCE_S = 2.0
"""Longest time for the end of the estimating process, s. The process also ends when the server has gone."""


class Showing:
    """Runs a conductor in a thread and keeps its newest report.

    A page that takes reports slowly misses some, and never delays another page.

    Parameters
    ----------
    conductor
        Runs the campaign from the start of the context to its end.
    """

    def __init__(self, conductor: Conducting) -> None:
        self.conductor = conductor
        self.failure: BaseException | None = None
        """Error that ended the campaign; None while it runs."""
        self._changed = Condition()
        self._report: SessionReport | None = None
        self._number = 0
        self._thread = Thread(target=self._run, name="campaign", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.conductor.stop()
        self._thread.join(PATIENCE_S)

    @property
    def at_work(self) -> bool:
        """Whether the conductor still runs."""
        return self._thread.is_alive()

    def newer(self, than: int, timeout_s: float) -> tuple[int, SessionReport] | None:
        """Wait for a report that is newer than a known one.

        Parameters
        ----------
        than
            Number of the known report, 0 for none.
        timeout_s
            Longest time to wait, s.

        Returns
        -------
        tuple of int and Report, or None
            Newest report and its number. None when no newer one came in time.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._number > than or self.failure is not None, timeout_s)
            return (self._number, self._report) if self._number > than and self._report else None

    def _run(self) -> None:
        try:
            self.conductor.run(self._keep)
        except BaseException as failure:
            with self._changed:
                self.failure = failure
                self._changed.notify_all()

    def _keep(self, report: SessionReport) -> None:
        with self._changed:
            self._report, self._number = report, self._number + 1
            self._changed.notify_all()
