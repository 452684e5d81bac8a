"""Speaking to another program than the vehicle: over a connection of its own, under the vehicle's ids."""

from typing import Any

from advisor.mavlink.connection import parse_connection
from advisor.mavlink.outgoing import Ids, Packer, Talker
from advisor.mavlink.transport import ConnectionCutError, Transport
from advisor.mavlink.transports import open_transport

REOPEN_EVERY_S = 1.0


class Aside(Talker):
    """Says to a ground station what a talker would say on the link.

    MAVProxy passes on to the vehicle what comes in by its ``--out``, and shows none of it. What comes in by
    its ``--master`` it shows when the text carries the system and component of its vehicle
    (MAVProxy, ``mavproxy_link.py``, ``message_is_from_primary_vehicle``).

    Parameters
    ----------
    talker
        Who speaks.
    connection
        Where to, see ``parse_connection``.

    Raises
    ------
    ConfigurationError
        When the connection string names no connection.
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
        """Nothing on the link; on the other connection, what is due."""
        if vehicle is not None and self._is_open(now_s):
            for message in self._talker.speak(vehicle, now_s):
                self._send(self._packer.pack(message, vehicle, 0))
        return []

    def leave(self, now_s: float) -> None:
        """Let go of the connection."""
        if self._transport is not None:
            self._transport.close()
            self._transport = None

    def report(self) -> list[str]:
        """Return whether the connection could be opened, once."""
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
