"""Task of the link's process, and its messages to and from its readers."""

import contextlib
import os
import secrets
import tempfile
from dataclasses import dataclass, field
from enum import Enum
from multiprocessing.connection import Client, Connection
from pathlib import Path
from typing import Literal

from advisor.mavlink.link.health import LinkStatistics


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
