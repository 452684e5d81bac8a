"""What the process of the link is asked to do, and what it and its readers send each other."""

import os
import secrets
import tempfile
from dataclasses import dataclass, field
from multiprocessing.connection import Client, Connection
from pathlib import Path
from typing import Literal

from advisor.mavlink.health import LinkStatistics, Notice


@dataclass(frozen=True, slots=True)
class Door:
    """Where the process of a link is spoken to; only who holds the key is let in."""

    address: str
    key: bytes = field(repr=False)

    def open(self) -> Connection:
        """Speak with the process.

        Raises
        ------
        OSError
            No process answers there.
        """
        return Client(self.address, authkey=self.key)


def new_door() -> Door:
    """Return a door that nobody else has: a local socket in a folder of its own, on Windows a named pipe."""
    name = secrets.token_hex(8)
    if os.name == "nt":
        return Door(rf"\\.\pipe\advisor-{name}", secrets.token_bytes(32))
    return Door(str(Path(tempfile.mkdtemp(prefix="advisor-")) / "link"), secrets.token_bytes(32))


@dataclass(frozen=True, slots=True)
class Keeping:
    """A link and its recording, as the process of the link opens them."""

    master: str
    """Connection, as in pymavlink."""
    door: Door
    source_system: int
    target_system: int | None = None
    record_to: Path | None = None
    goes_on: bool = False
    """The recording exists and is appended to."""
    signing_key: bytes | None = field(default=None, repr=False)
    request_rates: bool = False
    announce: bool = False
    announce_to: str | None = None
    """Connection to a ground station for announcements; None: they go over the link."""
    inherited: int | None = None
    """File descriptor of the UDP socket of an earlier process, in which packets wait; None: open one."""


@dataclass(frozen=True, slots=True)
class Hello:
    """The first answer to a reader: what was heard before it came."""

    recording: Path | None
    written: int
    """Bytes of the recording that the reader finds in the file."""
    unsaved: bytes
    """Records that follow and are not in the file yet."""
    before: int
    """Bytes at the start of the recording that an earlier flight left."""


@dataclass(frozen=True, slots=True)
class Heard:
    """The next records, for every reader."""

    at: int
    """Where the records stand in the recording, in bytes from its start."""
    records: bytes


@dataclass(frozen=True, slots=True)
class Told:
    """How the link is doing, several times a second, and what has happened to it since."""

    statistics: LinkStatistics
    notices: tuple[Notice, ...]


@dataclass(frozen=True, slots=True)
class Judged:
    """Asks the process of the link to announce a verdict, if it announces any."""

    maneuver: int
    sentence: str
    stop: str | None


@dataclass(frozen=True, slots=True)
class Order:
    """Asks for a call of one of the link's methods that say what a crew or a reader wants."""

    method: Literal["listen_to", "follow", "take_output", "ask_for_outputs"]
    arguments: tuple[object, ...] = ()


@dataclass(frozen=True, slots=True)
class Listen:
    """Asks for everything heard so far, and from now on."""


@dataclass(frozen=True, slots=True)
class Guard:
    """Tells that the sender looks after the process: when it goes without ``Stop``, the process is alone.

    The answer says whether the descriptor of a UDP socket follows.
    """


@dataclass(frozen=True, slots=True)
class Stop:
    """Asks the process to close the link and the recording, and to end."""
