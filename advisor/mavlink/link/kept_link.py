"""A link in a separate process, as its readers see it."""

import time
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from math import inf
from multiprocessing.connection import Connection
from types import TracebackType
from typing import TYPE_CHECKING, Self

from advisor.aircraft.controls import Elevator
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkNotice, LinkStatistics
from advisor.mavlink.link.keeping import AnnounceVerdict, CallOrder, Door, Heard, Hello, Listen, Told
from advisor.process.liveness import OLD_AFTER_S

if TYPE_CHECKING:
    from advisor.mavlink.link.decoding import Decoding

PIECE_BYTES = 262_144
"""Bytes of the recording that one ``read`` decodes: some 5,000 messages."""
RETRY_EVERY_S = 0.1
STARTED_WITHIN_S = 0.5
"""Time before the first connection to a new process, s, at most, within which that process began."""


class KeptLink:
    """Reads everything that the process of a link has heard since its beginning, then its new records.

    A restarted reader therefore comes to an equal campaign. After a restart of the link's process, the reader
    goes on where it was.

    Parameters
    ----------
    door
        Address of the process.
    elevator
        Elevator of the aircraft file, which shows which of several vehicles has one. None: by parameters.
    target_system
        System id of the vehicle; None: the first autopilot heard.
    """

    def __init__(
        self, door: Door, elevator: Elevator | None = None, target_system: int | None = None
    ) -> None:
        self._door = door
        self._elevator, self._target_system = elevator, target_system
        self._connection: Connection | None = None
        self._past: Iterator[bytes] = iter(())
        self._position = 0
        """Bytes of the recording read so far."""
        self._before = self._process = 0
        self._next_try_s = 0.0
        self._notices: list[LinkNotice] = []
        self._broken = False
        self._told = LinkStatistics()
        self._connected_s = self._vehicle_heard_s = -inf
        self._unanswered_s = 0.0
        self.catching_up = True
        """Whether earlier records are still being read."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._connection is not None:
            self._connection.close()

    def read(self, timeout_s: float = 0.1) -> list[Columns]:
        """Return the next messages in order of arrival, or nothing when none came in time."""
        if self._connection is None:
            self._connect(timeout_s)
        piece = next(self._past, None)
        if piece is None:
            self.catching_up = False
            piece = self._hear(timeout_s)
        columns = self._decoding.feed(piece) if piece else []
        # A process that was started again knows no vehicle, and a silent one would stay unknown.
        if self._connection is not None and (vehicle := self._decoding.newly_followed()) is not None:
            self._send(CallOrder("listen_to", (vehicle,)))
        return columns

    @property
    def statistics(self) -> LinkStatistics:
        """Health of the link, as reported last."""
        return self._decoding.counted(replace(self._told, unanswered_s=self._unanswered_s))

    def take_notices(self) -> list[LinkNotice]:
        """Return the notices since the last call, oldest first."""
        notices, self._notices = self._notices, []
        return notices

    def judged(self, maneuver: int, sentence: str, stop: str | None, axis: str = "") -> None:
        """Request the announcement of a verdict, unless the manoeuvre belongs to a continued recording."""
        if self._connection is not None and self._position > self._before:
            self._send(AnnounceVerdict(maneuver, sentence, stop, axis))

    def follow(self, system: int) -> None:
        """Follow another vehicle. The stream records the choice, and nothing is sent to a vehicle."""
        self._send(CallOrder("follow", (system,)))

    def take_output(self, output: int) -> None:
        """Use an output as the elevator. The stream records the choice, and nothing is sent to a vehicle."""
        self._send(CallOrder("take_output", (output,)))

    def ask_for_outputs(self) -> None:
        """Ask the vehicle once which of its outputs is the elevator."""
        self._send(CallOrder("ask_for_outputs"))

    @cached_property
    def _decoding(self) -> "Decoding":
        # Loaded by the reading process, not by the process that only names the link.
        from advisor.mavlink.link.decoding import Decoding

        return Decoding(self._elevator, self._target_system)

    def _connect(self, timeout_s: float) -> None:
        if time.monotonic() < self._next_try_s:
            time.sleep(min(timeout_s, RETRY_EVERY_S))
            self._wait_in_vain(min(timeout_s, RETRY_EVERY_S))
            return
        self._next_try_s = time.monotonic() + RETRY_EVERY_S
        try:
            connection = self._door.open()
            connection.send(Listen())
            hello = connection.recv()
        except (OSError, EOFError):
            return
        assert isinstance(hello, Hello)
        if self._broken:
            self._say("the process of the link has ended and was started again; the recording goes on")
            self._connected_s = time.monotonic()
        self._connection, self._broken = connection, False
        if hello.process != self._process:
            # The recording may lack what the last process passed on in its last moment: what follows is new.
            self._position = min(self._position, hello.before)
        self._before, self._process = hello.before, hello.process
        self._past = self._records_of(hello)
        self.catching_up = True
        self._decoding.forget_followed()

    def _records_of(self, hello: Hello) -> Iterator[bytes]:
        """Yield the records of the recording after the last read, in pieces."""
        if hello.recording is not None and self._position < hello.written:
            with hello.recording.open("rb") as file:
                file.seek(self._position)
                while self._position < hello.written:
                    piece = file.read(min(PIECE_BYTES, hello.written - self._position))
                    if not piece:
                        break
                    self._position += len(piece)
                    yield piece
        # A reader that was cut off from the same process has heard a part of it.
        unread = hello.unsaved[max(0, self._position - hello.written) :]
        self._position = hello.written + len(hello.unsaved)
        if unread:
            yield unread

    def _hear(self, timeout_s: float) -> bytes:
        """Return the next records of the process; empty when none came in time."""
        if self._connection is None:
            return b""
        try:
            while self._connection.poll(timeout_s):
                self._answered()
                match self._connection.recv():
                    case Heard(at, records) if at + len(records) > self._position:
                        self._position = at + len(records)
                        return records
                    case Told(statistics, notices):
                        self._told = self._remembering(statistics)
                        self._notices += notices
                        return b""
            self._wait_in_vain(timeout_s)
        except (OSError, EOFError):
            self._lose()
        return b""

    def _remembering(self, statistics: LinkStatistics) -> LinkStatistics:
        """Return statistics with the vehicle and the silence that an earlier process knew of."""
        now_s = time.monotonic()
        heard_s = now_s - statistics.silent_s
        # A process counts the silence from its own start.
        if heard_s > self._connected_s + STARTED_WITHIN_S:
            self._vehicle_heard_s = heard_s
        vehicle = statistics.vehicle or self._told.vehicle
        return replace(statistics, vehicle=vehicle, silent_s=now_s - self._vehicle_heard_s)

    def _wait_in_vain(self, seconds: float) -> None:
        """Take note of a wait in which the process has said nothing. It says something every 0.2 s."""
        before_s, self._unanswered_s = self._unanswered_s, self._unanswered_s + seconds
        if before_s < OLD_AFTER_S <= self._unanswered_s:
            self._say(f"the process of the link has not answered for {OLD_AFTER_S:.0f} s")

    def _answered(self) -> None:
        if self._unanswered_s >= OLD_AFTER_S:
            self._say("the process of the link answers again")
        self._unanswered_s = 0.0

    def _send(self, message: object) -> None:
        try:
            if self._connection is not None:
                self._connection.send(message)
        except OSError:
            self._lose()

    def _lose(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection, self._broken = None, True
        self._say("the process of the link has ended; it is started again")

    def _say(self, text: str) -> None:
        self._notices.append(LinkNotice(time.time(), text))
