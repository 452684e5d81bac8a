"""Interface of a link's transport: take bytes, give bytes, notice a cut.

Packets are read raw and never blocking, because decoding every message in Python would be the slow part, not
the socket.
"""

from abc import ABC, abstractmethod
from typing import Any

CHUNK_BYTES = 65536

Peer = tuple[Any, ...]


class ConnectionCutError(Exception):
    """The far end or the cable went away.

    Parameters
    ----------
    why
        Reason in words.
    listening
        Whether the transport waits for the next caller itself. Otherwise the caller opens the transport
        again.
    """

    def __init__(self, why: str, listening: bool = False) -> None:
        super().__init__(why)
        self.listening = listening


class Transport(ABC):
    """An open connection."""

    @abstractmethod
    def wait(self, timeout_s: float) -> bool:
        """Return whether bytes are available, after waiting at most ``timeout_s``."""

    @abstractmethod
    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return everything that has arrived, each piece with its sender."""

    @abstractmethod
    def send(self, data: bytes, to: Peer | None) -> bool:
        """Send to a known peer; return False without a receiver."""

    @abstractmethod
    def close(self) -> None:
        """Close the socket or line."""

    @property
    def port(self) -> int | None:
        """Local network port. None without one."""
        return None

    @property
    def descriptor(self) -> int | None:
        """File descriptor of a socket that another process can continue to use. None without one."""
        return None
