"""Announcements over a separate connection to a ground station, under the vehicle's ids."""

from typing import Any

from advisor.mavlink.link.connection import parse_connection
from advisor.mavlink.link.outgoing import Ids, Packer, Talker
from advisor.mavlink.link.transport import ConnectionCutError, Transport
from advisor.mavlink.link.transports import open_transport

REOPEN_EVERY_S = 1.0


class SeparateConnection(Talker):
    """Sends to a ground station the messages that a talker would send on the link.

    MAVProxy forwards messages from its ``--out`` to the vehicle, and shows none of them. MAVProxy shows a
    message from its ``--master`` when the text carries the system and component of its vehicle (MAVProxy,
    ``mavproxy_link.py``, ``message_is_from_primary_vehicle``).

    Parameters
    ----------
    talker
        Source of the messages.
    connection
        Connection string, see ``parse_connection``.

    Raises
    ------
    ConfigurationError
        The connection string names no connection.
    """

    def __init__(self, talker: Talker, connection: str) -> None:
        self._talker = talker
        self._address = parse_connection(connection)
        self._packer = Packer(None)
        self._transport: Transport | None = None
        self._reopen_at_s = float("-inf")
        self._said: list[str] = []
        self._failed = False

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Send the due messages on the other connection; return nothing for the link."""
        if vehicle is not None and self._is_open(now_s):
            for message in self._talker.speak(vehicle, now_s):
                self._send(self._packer.pack(message, vehicle, 0))
        return []

    def leave(self, now_s: float) -> None:
        """Close the connection."""
        if self._transport is not None:
            self._transport.close()
            self._transport = None

    def report(self) -> list[str]:
        """Return, once, a sentence where the connection could not be opened."""
        said, self._said = self._said, []
        return said

    def _is_open(self, now_s: float) -> bool:
        if self._transport is None and now_s >= self._reopen_at_s:
            self._reopen_at_s = now_s + REOPEN_EVERY_S
            try:
                self._transport = open_transport(self._address)
            except OSError as error:
                if not self._failed:
                    why = error.strerror or error
                    self._said.append(f"{self._address.text} cannot be opened for announcements: {why}")
                self._failed = True
        return self._transport is not None

    def _send(self, raw: bytes) -> None:
        if self._transport is None:
            return
        try:
            self._transport.receive()  # what a ground station says to the vehicle is not for us
            self._transport.send(raw, None)
        except ConnectionCutError:
            self.leave(0.0)
