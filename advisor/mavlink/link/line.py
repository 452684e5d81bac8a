"""Connection of a link, which is opened again after an interruption."""

import contextlib
import time
from threading import Event

from advisor.mavlink.link.transports import Address, ConnectionCutError, Peer, Transport, open_transport
from advisor.words.problems import UnusableInputError

REOPEN_EVERY_S = 1.0
_TRY_EVERY_S = 0.2


class Line:
    """One connection that is kept open.

    Parameters
    ----------
    inherited
        File descriptor of another process's UDP socket for the address. None to open a new socket.
    """

    def __init__(self, address: Address, inherited: int | None, stop: Event) -> None:
        self._address, self._inherited, self._stop = address, inherited, stop
        self._transport: Transport | None = None
        self._reopen_at_s = 0.0

    @property
    def is_open(self) -> bool:
        """Whether the connection can receive and send."""
        return self._transport is not None

    @property
    def port(self) -> int | None:
        """Local network port. None without a network port."""
        return self._transport.port if self._transport is not None else None

    @property
    def descriptor(self) -> int | None:
        """File descriptor of a socket that another process can continue to use. None without such a
        socket."""
        return self._transport.descriptor if self._transport is not None else None

    def open(self, patience_s: float) -> None:
        """Open the connection, with repeated attempts for ``patience_s``.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened.
        """
        give_up_s = time.monotonic() + patience_s
        while True:
            try:
                self._transport = open_transport(self._address, self._inherited)
                return
            except ImportError as error:
                raise UnusableInputError(
                    "no_connection",
                    f"{self._address.text} needs the Python package {error.name}.",
                    f"Install it with: pip install {error.name}",
                ) from None
            except OSError as error:
                if time.monotonic() >= give_up_s or self._address.kind.startswith(("udp", "tcpin")):
                    raise UnusableInputError(
                        "no_connection",
                        f"{self._address.text} cannot be opened: {error.strerror or error}.",
                        "Check the address, and that no other program uses it.",
                    ) from None
            self._stop.wait(_TRY_EVERY_S)

    def take(self, wait_s: float) -> list[tuple[Peer, bytes]]:
        """Return the bytes that have arrived, after waiting at most ``wait_s``. An interrupted connection is
        opened again.

        Raises
        ------
        ConnectionCutError
            The connection has just been interrupted.
        """
        if self._transport is None:
            self._reopen()
            return []
        try:
            return self._transport.receive() if self._transport.wait(wait_s) else []
        except ConnectionCutError as cut:
            if not cut.listening:
                self.close()
            raise

    def send(self, raw: bytes, to: Peer | None) -> bool:
        """Send a frame; return False without a receiver."""
        return self._transport is not None and self._transport.send(raw, to)

    def close(self) -> None:
        if self._transport is not None:
            self._transport.close()
            self._transport = None

    def _reopen(self) -> None:
        if time.monotonic() < self._reopen_at_s:
            self._stop.wait(0.05)
            return
        self._reopen_at_s = time.monotonic() + REOPEN_EVERY_S
        with contextlib.suppress(OSError):  # not yet back: tried again a second later
            self._transport = open_transport(self._address)
