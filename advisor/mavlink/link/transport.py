"""Interface of a link's transport: reception, transmission, and detection of an interruption.

Packets are read undecoded and never block, because decoding is slower than the socket.
"""

from abc import ABC, abstractmethod
from typing import Any

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
