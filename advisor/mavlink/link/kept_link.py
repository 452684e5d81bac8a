"""A link in a separate process: the process' task, its messages, and the link as seen by its readers."""

import contextlib
import os
import secrets
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from math import nan
from multiprocessing.connection import Client, Connection
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Self

from advisor.aircraft.aircraft import Elevator
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics, ReportedHealth
from advisor.process.liveness import OLD_AFTER_S

if TYPE_CHECKING:
    from advisor.mavlink.link.decoding import Decoding


@dataclass(frozen=True, slots=True)
class Door:
    """Address of a link's process. Only holders of the key can connect."""

    address: str
    key: bytes = field(repr=False)

    def open(self) -> Connection:
        """Connect to the process.

        Raises
        ------
        OSError
            No process answers at the address.
        """
        return Client(self.address, authkey=self.key)

    def clear(self) -> None:
        """Remove the files of a local socket."""
        if os.name != "nt":
            with contextlib.suppress(OSError):
                Path(self.address).unlink(missing_ok=True)
                Path(self.address).parent.rmdir()


def new_door() -> Door:
    """Return a new private address: a local socket in a separate folder, or a named pipe on Windows."""
    name = secrets.token_hex(8)
    if os.name == "nt":
        return Door(rf"\\.\pipe\advisor-{name}", secrets.token_bytes(32))
    return Door(str(Path(tempfile.mkdtemp(prefix="advisor-")) / "link"), secrets.token_bytes(32))


@dataclass(frozen=True, slots=True)
class Keeping:
    """Description of a link and its recording, for the process of the link."""

    master: str
    """Connection, as in pymavlink."""
    door: Door
    target_system: int | None = None
    record_to: Path | None = None
    goes_on: bool = False
    """Whether the recording exists and is continued."""
    signing_key: bytes | None = field(default=None, repr=False)
    request_rates: bool = False
    announce: bool = False
    announce_to: str | None = None
    """Connection to a ground station for announcements. None for announcements over the link itself."""
    uplink: bool = False
    """Whether the next input is sent to the autopilot's script."""
    inherited: int | None = None
    """File descriptor of an earlier process's UDP socket, in which packets wait. None to open a new
    socket."""


@dataclass(frozen=True, slots=True)
class Hello:
    """First answer of the link's process to a reader, with the position in the recording."""

    recording: Path | None
    written: int
    """Number of bytes in the recording's file."""
    unsaved: bytes
    """Records after these bytes that are not in the file yet."""
    before: int
    """Number of bytes at the recording's start from an earlier flight or process."""
    process: int = field(default_factory=os.getpid)
    """Id of the answering process."""


@dataclass(frozen=True, slots=True)
class Heard:
    """Next records of the link, for every reader."""

    at: int
    """Position of the records in the recording, bytes from its start."""
    records: bytes
    newest_s: float
    """Host time of the newest record, seconds since 1970."""


@dataclass(frozen=True, slots=True)
class Told:
    """Health of the link, several times a second, with the notices since the last one."""

    statistics: LinkStatistics
    notices: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CallOrder:
    """Order to call one of the link's methods, from a crew or a reader."""

    method: Literal["listen_to", "follow", "take_output", "ask_for_outputs"]
    arguments: tuple[object, ...] = ()


@dataclass(frozen=True, slots=True)
class AnnounceOrder:
    """Order to call one of the methods of ``announce.Announcer``, if announcements are on."""

    method: Literal["judged", "say"]
    arguments: tuple[object, ...]


@dataclass(frozen=True, slots=True)
class UplinkOrder:
    """Next input for the autopilot's script, if the uplink is on: number, size in deg, time unit in s."""

    which: int
    size_deg: float
    unit_s: float


class Request(Enum):
    """Request of a caller to the link's process."""

    LISTEN = "listen"
    """Request for all records so far, and for all later records."""
    OBSERVE = "observe"
    """Request for the link's health only, without records and notices."""
    GUARD = "guard"
    """Request to guard the process. A caller that ends without ``STOP`` leaves the process unguarded. The
    answer states whether the descriptor of a UDP socket follows."""
    ALIVE = "alive"
    """Request for the time since the link's slowest thread last worked, s."""
    STOP = "stop"
    """Request to close the link and the recording, and to end the process."""


PIECE_BYTES = 262_144
"""Bytes of the recording that one ``read`` decodes: about 5,000 messages."""
RETRY_EVERY_S = 0.1


class KeptLink:
    """Reader of all records of a link's process, from the beginning.

    A restarted reader therefore makes an equal campaign. After a restart of the link's process, the
    reader continues at its position.

    Parameters
    ----------
    elevator
        Elevator of the aircraft file, which shows which vehicle has one. None to decide by parameters.
    """

    def __init__(
        self, door: Door, elevator: Elevator | None = None, target_system: int | None = None
    ) -> None:
        self._door = door
        self._elevator, self._target_system = elevator, target_system
        self._connection: Connection | None = None
        self._past: Iterator[bytes] = iter(())
        self._position = 0
        """Number of bytes of the recording read so far."""
        self._before = self._process = 0
        self._next_try_s = 0.0
        self._notices: list[str] = []
        self._broken = False
        self._health = ReportedHealth()
        self.read_to_s = nan
        """Host time of the newest record that was read, seconds since 1970."""
        self.catching_up = True
        """Whether earlier records are still being read."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._connection is not None:
            self._connection.close()

    def read(self, timeout_s: float = 0.1) -> list[Columns]:
        """Return the next messages in order of arrival, or an empty list after the timeout."""
        if self._connection is None:
            self._connect(timeout_s)
        piece = next(self._past, None)
        if piece is None:
            self.catching_up = False
            piece = self._hear(timeout_s)
        columns = self._decoding.feed(piece) if piece else []
        if self.catching_up:
            self.read_to_s = max((float(part.arrival_s[-1]) for part in columns), default=self.read_to_s)
        # A process that was started again knows no vehicle, and a silent one would stay unknown.
        if self._connection is not None and (vehicle := self._decoding.newly_followed()) is not None:
            self._send(CallOrder("listen_to", (vehicle,)))
        return columns

    @property
    def statistics(self) -> LinkStatistics:
        """Health of the link in the newest report."""
        return self._decoding.counted(self._health.statistics)

    def take_notices(self) -> list[str]:
        """Return the notices since the last call, oldest first."""
        notices, self._notices = self._notices, []
        return notices

    def judged(self, maneuver: int, sentence: str, stop: str, axis: str = "", about: str = "") -> None:
        """Request the announcement of a verdict, unless the manoeuvre belongs to a continued recording."""
        if self._connection is not None and self._position > self._before:
            self._send(AnnounceOrder("judged", (maneuver, sentence, stop, axis, about)))

    def advise(self, which: int, size_deg: float, unit_s: float) -> None:
        """Send the next input to the autopilot's script, unless an earlier flight advised the input."""
        if self._connection is not None and self._position > self._before:
            self._send(UplinkOrder(which, size_deg, unit_s))

    def follow(self, system: int) -> None:
        """Follow another vehicle. The stream records the choice; nothing is sent to a vehicle."""
        self._send(CallOrder("follow", (system,)))

    def take_output(self, output: int) -> None:
        """Use an output as the elevator. The stream records the choice; nothing is sent to a vehicle."""
        self._send(CallOrder("take_output", (output,)))

    def ask_for_outputs(self) -> None:
        """Request once from the vehicle which output is its elevator."""
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
            connection.send(Request.LISTEN)
            hello = connection.recv()
        except (OSError, EOFError):
            return
        assert isinstance(hello, Hello)
        if self._broken:
            self._say("the process of the link has ended and was started again; the recording goes on")
            self._health.reconnected()
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
        if self._connection is None:
            return b""
        try:
            while self._connection.poll(timeout_s):
                self._answered()
                match self._connection.recv():
                    case Heard(at, records, newest_s) if at + len(records) > self._position:
                        self._position = at + len(records)
                        self.read_to_s = newest_s
                        return records
                    case Told(statistics, notices):
                        self._health.take(statistics)
                        self._notices += notices
                        return b""
            self._wait_in_vain(timeout_s)
        except (OSError, EOFError):
            self._lose()
        return b""

    def _wait_in_vain(self, seconds: float) -> None:
        """Record a wait in which the process sent nothing."""
        if self._health.waited(seconds):
            self._say(f"the process of the link has not answered for {OLD_AFTER_S:.0f} s")

    def _answered(self) -> None:
        if self._health.answered():
            self._say("the process of the link answers again")

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
        self._notices.append(text)
