"""The sockets and serial lines under a link: open, take bytes, give bytes, notice a cut.

Packets are read raw, with a large receive buffer and never blocking: a parser that
decodes every message in Python is the slow part of the usual way, not the socket.
"""

import contextlib
import select
import socket
from abc import ABC, abstractmethod
from typing import Any

from advisor.mavlink.connection import Address

RECEIVE_BUFFER_BYTES = 4 * 1024 * 1024  # at the usual 208 kB a busy machine loses packets
_CHUNK = 65536
_MOST_CHUNKS = 512  # taken in one go, so that a flood cannot keep the reader from handing over

Peer = tuple[Any, ...]


class ConnectionCutError(Exception):
    """The far end or the cable went away.

    Parameters
    ----------
    why
        In words.
    listening
        The transport waits for the next caller by itself; otherwise it is to be opened again.
    """

    def __init__(self, why: str, listening: bool = False) -> None:
        super().__init__(why)
        self.listening = listening


class Transport(ABC):
    """An open connection."""

    @abstractmethod
    def wait(self, timeout_s: float) -> bool:
        """Whether bytes are there, waiting for them at most so long."""

    @abstractmethod
    def receive(self) -> list[tuple[Peer, bytes]]:
        """Everything that has arrived, each piece with its sender."""

    @abstractmethod
    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send to a peer heard before; False when nobody is there to send to."""

    @abstractmethod
    def close(self) -> None:
        """Let go of the socket or line."""

    @property
    def port(self) -> int | None:
        """The local network port; None when there is none."""
        return None


class UdpTransport(Transport):
    """UDP, listening (``udpin``) or calling (``udpout``)."""

    def __init__(self, address: Address) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        self._remote: Peer | None = None
        try:
            if address.kind == "udpin":
                self._socket.bind((address.host, address.port))
            else:
                self._remote = (socket.gethostbyname(address.host), address.port)
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)

    def wait(self, timeout_s: float) -> bool:
        """Whether bytes are there."""
        return bool(select.select([self._socket], [], [], timeout_s)[0])

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Everything that has arrived."""
        pieces: list[tuple[Peer, bytes]] = []
        for _ in range(_MOST_CHUNKS):
            try:
                data, peer = self._socket.recvfrom(_CHUNK)
            except BlockingIOError:
                break
            except ConnectionError:  # an earlier packet of ours found nobody: silence, not an end
                continue
            pieces.append((peer, data))
        return pieces

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send; False when nobody is there to send to."""
        target = self._remote or to
        if target is None:
            return False
        with contextlib.suppress(OSError):  # an unreachable peer is heard again or it is silent
            self._socket.sendto(data, target)
        return True

    def close(self) -> None:
        """Let go."""
        self._socket.close()

    @property
    def port(self) -> int | None:
        """The local port."""
        return int(self._socket.getsockname()[1])


class StreamTransport(Transport):
    """TCP, calling (``tcp``) or waiting for one caller after the other (``tcpin``); a local socket."""

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
        """Whether bytes are there."""
        ends = [end for end in (self._stream or self._listener,) if end is not None]
        ready = select.select(ends, [], [], timeout_s)[0]
        if ready and self._stream is None and self._listener is not None:
            with contextlib.suppress(OSError):  # a caller that hung up again at once
                self._adopt(self._listener.accept()[0])
            return False
        return bool(ready)

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Everything that has arrived."""
        if self._stream is None:
            return []
        try:
            data = self._stream.recv(_CHUNK)
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
        """Send; False when nobody is there to send to."""
        if self._stream is None:
            return False
        with contextlib.suppress(OSError):  # the next read tells that the line is cut
            self._stream.sendall(data)
        return True

    def close(self) -> None:
        """Let go."""
        for end in (self._stream, self._listener):
            if end is not None:
                end.close()

    @property
    def port(self) -> int | None:
        """The local port."""
        end = self._listener or self._stream
        return None if end is None or end.family == socket.AF_UNIX else int(end.getsockname()[1])


class SerialTransport(Transport):
    """A serial line: radio, USB, or a pseudo-terminal."""

    def __init__(self, address: Address) -> None:
        import serial

        self._line = serial.Serial(address.host, address.port, timeout=0, write_timeout=0.5, exclusive=True)

    def wait(self, timeout_s: float) -> bool:
        """Whether bytes are there."""
        try:
            return bool(select.select([self._line.fileno()], [], [], timeout_s)[0])
        except (OSError, ValueError, TypeError) as error:
            raise ConnectionCutError(str(error)) from None

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Everything that has arrived."""
        try:
            data = self._line.read(_CHUNK)
        except (OSError, TypeError) as error:  # pyserial's own error is an OSError
            raise ConnectionCutError(str(error)) from None
        return [((), data)] if data else []

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send; False when nobody is there to send to."""
        with contextlib.suppress(OSError):  # the next read tells that the line is cut
            self._line.write(data)
        return True

    def close(self) -> None:
        """Let go."""
        self._line.close()


class PymavlinkTransport(Transport):
    """The rarer kinds (multicast, broadcast, web sockets), opened by pymavlink, read raw."""

    def __init__(self, address: Address) -> None:
        from pymavlink import mavutil

        self._connection = mavutil.mavlink_connection(address.text)
        self._may_end = address.text.startswith("ws")

    def wait(self, timeout_s: float) -> bool:
        """Whether bytes are there."""
        return bool(self._connection.select(timeout_s))

    def receive(self) -> list[tuple[Peer, bytes]]:
        """Everything that has arrived."""
        data = bytes(self._connection.recv(_CHUNK))
        if not data and self._may_end:
            raise ConnectionCutError("closed by the other side")
        return [((), data)] if data else []

    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send; False when nobody is there to send to."""
        with contextlib.suppress(OSError):
            self._connection.write(data)
        return True

    def close(self) -> None:
        """Let go."""
        self._connection.close()


def open_transport(address: Address) -> Transport:
    """Open what an address names.

    Raises
    ------
    OSError
        When it cannot be opened now: port taken, nobody answering, no such device.
    """
    match address.kind:
        case "udpin" | "udpout":
            return UdpTransport(address)
        case "tcp" | "tcpin" | "unix":
            return StreamTransport(address)
        case "serial":
            return SerialTransport(address)
        case "pymavlink":
            return PymavlinkTransport(address)
