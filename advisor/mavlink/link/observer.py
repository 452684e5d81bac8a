"""Health of a link, received from its process by a program that reads no records."""

import contextlib
from collections.abc import Callable
from multiprocessing.connection import Connection
from threading import Event, Thread
from typing import Self

from advisor.mavlink.link.health import LinkStatistics, ReportedHealth
from advisor.mavlink.link.kept_link import AnnounceOrder, Door, Request, Told

LOOK_EVERY_S = 0.25
"""Longest wait for a report, and time between two attempts to connect, s. Reports come every 0.2 s."""


class LinkObserver:
    """Observer that reports a link's health several times a second while the context is open.

    Neither estimates nor waiting records delay these reports.

    Parameters
    ----------
    door
        Address of the process. None if no process keeps a link, so that nothing is reported.
    """

    def __init__(self, door: Door | None, tell: Callable[[LinkStatistics], object]) -> None:
        self._door, self._tell = door, tell
        self._health = ReportedHealth()
        self._connection: Connection | None = None
        self._broken = False
        self._over = Event()
        self._thread = Thread(target=self._run, name="observer", daemon=True)

    def __enter__(self) -> Self:
        if self._door is not None:
            self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        if self._door is not None:
            self._thread.join()

    def announce(self, sentence: str) -> None:
        """Request the announcement of a sentence, if announcements are on."""
        with contextlib.suppress(OSError):
            if self._connection is not None:
                self._connection.send(AnnounceOrder("say", (sentence,)))

    def _run(self) -> None:
        while not self._over.is_set():
            try:
                self._observe()
            except (OSError, EOFError):
                self._connection, self._broken = None, True
                self._over.wait(LOOK_EVERY_S)
                self._wait_in_vain()

    def _observe(self) -> None:
        assert self._door is not None
        with self._door.open() as connection:
            connection.send(Request.OBSERVE)
            self._connection = connection
            if self._broken:
                self._health.reconnected()
            while not self._over.is_set():
                if not connection.poll(LOOK_EVERY_S):
                    self._wait_in_vain()
                    continue
                answer = connection.recv()
                assert isinstance(answer, Told)
                self._health.answered()
                self._health.take(answer.statistics)
                self._tell(self._health.statistics)

    def _wait_in_vain(self) -> None:
        self._health.waited(LOOK_EVERY_S)
        self._tell(self._health.statistics)
