"""Transports of a link (UDP, TCP, local sockets, serial lines, rarer kinds by pymavlink), and their
connection strings.

Packets are read undecoded and never block, because decoding is slower than the socket.
"""

import contextlib
import errno
import os
import select
import socket
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from advisor.words.problems import ConfigurationError

Kind = Literal["udpin", "udpout", "tcp", "tcpin", "unix", "serial", "pymavlink"]

DEFAULT_BAUD = 57600  # telemetry radios and ArduPilot's TELEM1 come set to it

_NETWORK_KINDS: dict[str, Kind] = {
    "udpin": "udpin",
    "udp": "udpin",
    "udpout": "udpout",
    "tcp": "tcp",
    "tcpout": "tcp",
    "tcpin": "tcpin",
}
_LEFT_TO_PYMAVLINK = ("udpbcast", "mcast", "ws", "wss", "wsserver")
_EXAMPLES = "udpin:0.0.0.0:14550, udpout:host:14550, tcp:host:5760, tcpin:0.0.0.0:5760 or /dev/ttyUSB0,57600"


@dataclass(frozen=True, slots=True)
class Address:
    """One parsed connection string."""

    kind: Kind
    host: str
    """Host to listen on or to connect to; empty for all interfaces. For other connections the serial device,
    or the path of a local socket."""
    port: int
    """Network port, or the baud rate of a serial line."""
    text: str
    """Connection string as the user wrote it."""

    @property
    def speaks_first(self) -> bool:
        """Whether a packet must be sent before any is received, so that the peer learns the advisor's
        address."""
        return self.kind == "udpout"


def parse_connection(text: str) -> Address:
    """Read a connection string.

    Parameters
    ----------
    text
        String in pymavlink's form (``udpin:``, ``udpout:``, ``udp:``, ``tcp:``, ``tcpin:``,
        ``/dev/ttyX,57600``, bare ``host:port`` listens on UDP) or MAVSDK's
        (``udpin://``, ``udpout://``, ``tcpout://``, ``serial://device:baud``).

    Raises
    ------
    ConfigurationError
        The string names no connection. The message shows examples.
    """
    text = text.strip()
    scheme, colon, rest = text.partition(":")
    mavsdk = rest.startswith("//")
    if mavsdk:
        rest = rest[2:]
    scheme = scheme.lower()
    if colon and scheme in _NETWORK_KINDS:
        return _network(_NETWORK_KINDS[scheme], rest, text)
    if scheme in ("uds", "unix") and rest:
        return Address("unix", rest, 0, text)
    if colon and scheme in _LEFT_TO_PYMAVLINK:
        return Address("pymavlink", rest, 0, text)
    if colon and scheme in ("serial", "serial_flowcontrol"):
        device, _, baud = rest.rpartition(":") if ":" in rest else (rest, "", "")
        return _serial(device, baud, text)
    if mavsdk:
        raise ConfigurationError(f"Connection {text!r}: unknown kind {scheme!r}; write {_EXAMPLES}.")
    if text.startswith("/dev/") or text.upper().startswith("COM") or "," in text:
        device, _, baud = text.partition(",")
        return _serial(device, baud, text)
    if Path(text).is_file():
        raise ConfigurationError(f"Connection {text!r} is a file; a log is read with: advisor replay {text}.")
    if colon and "/" not in text:
        return _network("udpin", text, text)
    raise ConfigurationError(f"Connection {text!r} is not understood; write {_EXAMPLES}.")


def _network(kind: Kind, rest: str, text: str) -> Address:
    host, colon, port_text = rest.rstrip("/").rpartition(":")
    lowest = 0 if kind in ("udpin", "tcpin") else 1  # listening on 0: the system chooses
    if not colon or not port_text.isdigit() or not lowest <= int(port_text) < 65536:
        raise ConfigurationError(f"Connection {text!r} has no port between 1 and 65535; write {_EXAMPLES}.")
    if ":" in host and not host.startswith("["):
        raise ConfigurationError(f"Connection {text!r} has too many colons; write {_EXAMPLES}.")
    if not host and kind in ("udpout", "tcp"):
        raise ConfigurationError(f"Connection {text!r} names no host to call; write {_EXAMPLES}.")
    return Address(kind, host.strip("[]"), int(port_text), text)


def _serial(device: str, baud: str, text: str) -> Address:
    if not device or (baud and not baud.isdigit()):
        raise ConfigurationError(f"Connection {text!r}: a serial line is written /dev/ttyUSB0,57600.")
    return Address("serial", device, int(baud) if baud else DEFAULT_BAUD, text)


CHUNK_BYTES = 65536

Peer = tuple[Any, ...]


class ConnectionCutError(Exception):
    """The peer or the cable was disconnected.

    Parameters
    ----------
    listening
        Whether the transport itself waits for the next caller. Otherwise the caller opens the transport
        again.
    """

    def __init__(self, why: str, listening: bool = False) -> None:
        super().__init__(why)
        self.listening = listening


class Transport(ABC):
    """An open connection of a link."""

    @abstractmethod
    def wait(self, timeout_s: float) -> bool:
        """Return whether bytes are available, after waiting at most ``timeout_s``."""

    @abstractmethod
    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return all bytes that have arrived, each piece with its sender."""

    @abstractmethod
    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send to a known peer; return False without a receiver."""

    @abstractmethod
    def close(self) -> None:
        """Close the socket or line."""

    @property
    def port(self) -> int | None:
        """Local network port. None without a network port."""
        return None

    @property
    def descriptor(self) -> int | None:
        """File descriptor of a socket that another process can continue to use. None without such a
        socket."""
        return None


RECEIVE_BUFFER_BYTES = 4 * 1024 * 1024  # at the usual 208 kB a busy machine loses packets
_MOST_CHUNKS = 512  # taken in one go, so that a flood cannot keep the reader from handing over


class UdpTransport(Transport):
    """UDP transport, listening (``udpin``) or connecting (``udpout``).

    Parameters
    ----------
    inherited
        File descriptor of another process's socket. None to open a new socket.
    """

    def __init__(self, address: Address, inherited: int | None = None) -> None:
        self._remote: Peer | None = None
        if address.kind == "udpout":
            self._remote = (socket.gethostbyname(address.host), address.port)
        if inherited is None:
            self._open(address)
        else:
            self._socket = socket.socket(fileno=inherited)
        self._socket.setblocking(False)

    def _open(self, address: Address) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        try:
            if address.kind == "udpin":
                self._socket.bind((address.host, address.port))
        except OSError:
            self._socket.close()
            raise

    def wait(self, timeout_s: float) -> bool:
        return bool(select.select([self._socket], [], [], timeout_s)[0])

    def receive(self) -> list[tuple[Peer, bytes]]:
        pieces: list[tuple[Peer, bytes]] = []
        for _ in range(_MOST_CHUNKS):
            try:
                data, peer = self._socket.recvfrom(CHUNK_BYTES)
            except BlockingIOError:
                break
            except ConnectionError:  # an earlier packet of ours found nobody: silence, not an end
                continue
            pieces.append((peer, data))
        return pieces

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send bytes; return False without a receiver."""
        target = self._remote or to
        if target is None:
            return False
        with contextlib.suppress(OSError):  # an unreachable peer is heard again or it is silent
            self._socket.sendto(data, target)
        return True

    def close(self) -> None:
        self._socket.close()

    @property
    def port(self) -> int | None:
        return int(self._socket.getsockname()[1])

    @property
    def descriptor(self) -> int | None:
        return self._socket.fileno()


class StreamTransport(Transport):
    """TCP transport, connecting (``tcp``) or accepting one caller after another (``tcpin``); or a local
    socket."""

    def __init__(self, address: Address, timeout_s: float = 2.0) -> None:
        self._listener: socket.socket | None = None
        self._stream: socket.socket | None = None
        if address.kind == "tcpin":
            self._listener = socket.create_server((address.host, address.port), reuse_port=False)
            self._listener.setblocking(False)
        elif address.kind == "unix":
            stream = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                stream.connect(address.host)
            except OSError:
                stream.close()
                raise
            self._adopt(stream)
        else:
            self._adopt(socket.create_connection((address.host, address.port), timeout=timeout_s))

    def _adopt(self, stream: socket.socket) -> None:
        stream.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        if stream.family != socket.AF_UNIX:
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        stream.setblocking(False)
        self._stream = stream

    def wait(self, timeout_s: float) -> bool:
        ends = [end for end in (self._stream or self._listener,) if end is not None]
        ready = select.select(ends, [], [], timeout_s)[0]
        if ready and self._stream is None and self._listener is not None:
            with contextlib.suppress(OSError):  # a caller that hung up again at once
                self._adopt(self._listener.accept()[0])
            return False
        return bool(ready)

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return everything that has arrived."""
        if self._stream is None:
            return []
        try:
            data = self._stream.recv(CHUNK_BYTES)
        except BlockingIOError:
            return []
        except OSError as error:
            raise self._cut(error.strerror or str(error)) from None
        if not data:
            raise self._cut("closed by the other side")
        return [((), data)]

    def _cut(self, why: str) -> ConnectionCutError:
        if self._stream is not None:
            self._stream.close()
            self._stream = None
        return ConnectionCutError(why, listening=self._listener is not None)

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send bytes; return False without a receiver."""
        if self._stream is None:
            return False
        with contextlib.suppress(OSError):  # the next read tells that the line is cut
            self._stream.sendall(data)
        return True

    def close(self) -> None:
        for end in (self._stream, self._listener):
            if end is not None:
                end.close()

    @property
    def port(self) -> int | None:
        end = self._listener or self._stream
        return None if end is None or end.family == socket.AF_UNIX else int(end.getsockname()[1])


class SerialTransport(Transport):
    """A serial line: radio, USB, or a pseudo-terminal."""

    def __init__(self, address: Address) -> None:
        import serial

        if not _is_terminal(address.host):
            raise OSError(errno.ENOTTY, "this is no serial line")
        self._line = serial.Serial(address.host, address.port, timeout=0, write_timeout=0.5, exclusive=True)

    def wait(self, timeout_s: float) -> bool:
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
        self._line.close()


class PymavlinkTransport(Transport):
    """Rare kinds of connections (multicast, broadcast, web sockets), opened by pymavlink."""

    def __init__(self, address: Address) -> None:
        from pymavlink import mavutil

        self._connection = mavutil.mavlink_connection(address.text)
        self._may_end = address.text.startswith("ws")

    def wait(self, timeout_s: float) -> bool:
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
