"""Opening of connections: serial lines, and rarer kinds by pymavlink."""

import contextlib
import errno
import os
import select

from advisor.mavlink.link.connection import Address
from advisor.mavlink.link.sockets import StreamTransport, UdpTransport
from advisor.mavlink.link.transport import CHUNK_BYTES, ConnectionCutError, Peer, Transport


class SerialTransport(Transport):
    """A serial line: radio, USB, or a pseudo-terminal."""

    def __init__(self, address: Address) -> None:
        import serial

        if not _is_terminal(address.host):
            raise OSError(errno.ENOTTY, "this is no serial line")
        self._line = serial.Serial(address.host, address.port, timeout=0, write_timeout=0.5, exclusive=True)

    def wait(self, timeout_s: float) -> bool:
        """Return whether bytes are available."""
        try:
            return bool(select.select([self._line.fileno()], [], [], timeout_s)[0])
        except (OSError, ValueError, TypeError) as error:
            raise ConnectionCutError(str(error)) from None

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return everything that has arrived."""
        try:
            data = self._line.read(CHUNK_BYTES)
        except (OSError, TypeError) as error:  # pyserial's own error is an OSError
            raise ConnectionCutError(str(error)) from None
        return [((), data)] if data else []

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send bytes; return False without a receiver."""
        with contextlib.suppress(OSError):  # the next read tells that the line is cut
            self._line.write(data)
        return True

    def close(self) -> None:
        """Close the line."""
        self._line.close()


class PymavlinkTransport(Transport):
    """Rare kinds of connections (multicast, broadcast, web sockets), opened by pymavlink."""

    def __init__(self, address: Address) -> None:
        from pymavlink import mavutil

        self._connection = mavutil.mavlink_connection(address.text)
        self._may_end = address.text.startswith("ws")

    def wait(self, timeout_s: float) -> bool:
        """Return whether bytes are available."""
        return bool(self._connection.select(timeout_s))

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return everything that has arrived."""
        data = bytes(self._connection.recv(CHUNK_BYTES))
        if not data and self._may_end:
            raise ConnectionCutError("closed by the other side")
        return [((), data)] if data else []

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send bytes; return False without a receiver."""
        with contextlib.suppress(OSError):
            self._connection.write(data)
        return True

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()


def _is_terminal(path: str) -> bool:
    """Return whether a file is a serial line. A name without a file may be a serial line of Windows."""
    if not os.path.exists(path):
        return True
    end = os.open(path, os.O_RDWR | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_NONBLOCK", 0))
    try:
        return os.isatty(end)
    finally:
        os.close(end)


def open_transport(address: Address, inherited: int | None = None) -> Transport:
    """Open the transport of an address.

    Parameters
    ----------
    inherited
        File descriptor of another process's UDP socket for this address. None to open a new socket.

    Raises
    ------
    OSError
        The connection cannot be opened now. The port is taken, nobody answers, or the device does not exist.
    """
    match address.kind:
        case "udpin" | "udpout":
            return UdpTransport(address, inherited)
        case "tcp" | "tcpin" | "unix":
            return StreamTransport(address)
        case "serial":
            return SerialTransport(address)
        case "pymavlink":
            return PymavlinkTransport(address)
