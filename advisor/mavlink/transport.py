"""What a link needs of whatever lies under it: take bytes, give bytes, notice a cut.

Packets are read raw and never blocking: a parser that decodes every message in Python is the
slow part of the usual way, not the socket.
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
        """Return whether bytes are there, waiting for them at most so long."""

    @abstractmethod
    def receive(self) -> list[tuple[Peer, bytes]]:
        """Return everything that has arrived, each piece with its sender."""

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

    @property
    def descriptor(self) -> int | None:
        """File descriptor of a socket that another process can go on with; None where there is none."""
        return None
