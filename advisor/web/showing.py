"""A running campaign and its newest report, shared by any number of pages.

The module also holds the connection to the campaign's processes.
"""

import time
from collections.abc import Callable
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, Listener
from threading import Condition, Event, Thread
from typing import Self

from advisor.aircraft.aircraft import Aircraft
from advisor.mavlink.link.kept_link import new_door
from advisor.session.conducting import Conducting, SessionReport, Tempo, changes
from advisor.tui.settings import Settings

ADDRESS, KEY = "ADVISOR_PAGE_ADDRESS", "ADVISOR_PAGE_KEY"
"""Environment variables with the address of the server's entrance and its key, for the process of a page.

A process list shows arguments to every user. The environment is readable by its own user alone.
"""


@dataclass(frozen=True, slots=True)
class Viewing:
    """Data that the application of a page needs before its first report."""

    aircraft: Aircraft
    title: str
    """Name of the log or of the connection."""
    tempo: Tempo | None
    """Tempo of a replay at the start. None: the source is a live link."""
    settings: Settings
    watch_only: bool = False
    """Whether the page may neither decide by hand nor send requests to the link."""


PATIENCE_S = 2.0
"""Longest waiting time for the end of the estimating process, s. The estimating process also ends when the
server has ended."""


class Showing:
    """Runs a conductor in a thread and keeps its newest report.

    A page that receives reports slowly skips some, and never delays another page.
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

    def __exit__(self, *error: object) -> None:
        self.conductor.stop()
        self._thread.join(PATIENCE_S)

    @property
    def at_work(self) -> bool:
        """Whether the conductor is still running."""
        return self._thread.is_alive()

    def newer(self, than: int, timeout_s: float) -> tuple[int, SessionReport] | None:
        """Wait for a report that is newer than a known one.

        Returns
        -------
        tuple of int and Report, or None
            Newest report and its number. None if no newer report came in time.
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


LOOK_EVERY_S = 0.2
"""Time after which a page without messages is tested for its end, s."""
_OWN_REPLAY = frozenset({"jump", "play", "step"})
_BY_HAND = frozenset({"decide", "order"})


class Audience:
    """Accepts pages, sends reports to each, and receives the requests of each.

    Parameters
    ----------
    shared
        Campaign that all pages show. None: each page has a campaign of its own.
    """

    def __init__(
        self, viewing: Viewing, shared: Showing | None, make_conductor: Callable[[], Conducting]
    ) -> None:
        self.door = new_door()
        self._viewing, self._shared, self._make_conductor = viewing, shared, make_conductor
        self._heeded = _OWN_REPLAY if viewing.watch_only else _OWN_REPLAY | _BY_HAND
        self._listener = Listener(self.door.address, authkey=self.door.key)
        self._closing = Event()
        self._pages: list[Thread] = []

    def __enter__(self) -> Self:
        Thread(target=self._accept, name="door", daemon=True).start()
        return self

    def __exit__(self, *error: object) -> None:
        self._closing.set()
        self._listener.close()
        self.door.clear()
        give_up_s = time.monotonic() + PATIENCE_S
        for page in self._pages:
            page.join(max(0.0, give_up_s - time.monotonic()))

    def _accept(self) -> None:
        while not self._closing.is_set():
            try:
                connection = self._listener.accept()
            except Exception:  # a caller without the key, or one that hung up
                time.sleep(0.01)
                continue
            self._pages = [page for page in self._pages if page.is_alive()]
            self._pages.append(Thread(target=self._serve, args=(connection,), name="page", daemon=True))
            self._pages[-1].start()

    def _serve(self, connection: Connection) -> None:
        gone = Event()
        own = None if self._shared is not None else Showing(self._make_conductor())
        with suppress(OSError), connection, own or nullcontext():
            showing = own or self._shared
            assert showing is not None
            connection.send(self._viewing)
            asking = Thread(target=self._obey, args=(connection, showing.conductor, gone), daemon=True)
            asking.start()
            try:
                self._report(connection, showing, gone)
            finally:
                gone.set()
                asking.join()  # a connection that a thread still reads would stay open

    def _report(self, connection: Connection, showing: Showing, gone: Event) -> None:
        """Send the first report completely, then the changes since the last report."""
        number, last = 0, None
        while not gone.is_set() and not self._closing.is_set():
            newer = showing.newer(number, LOOK_EVERY_S)
            if newer is not None:
                number, report = newer
                connection.send(report if last is None else changes(last, report))
                last = report
            elif showing.failure is not None:
                connection.send(showing.failure)
                return

    def _obey(self, connection: Connection, conductor: Conducting, gone: Event) -> None:
        """Send the page's requests to the conductor, until the page is closed."""
        with suppress(EOFError, OSError):
            while not gone.is_set():
                if not connection.poll(LOOK_EVERY_S):
                    continue
                name, arguments = connection.recv()
                if name in self._heeded:
                    getattr(conductor, name)(*arguments)
        gone.set()
