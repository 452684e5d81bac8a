"""Messages that the advisor sends, packed under its own ids and signed if a key is given."""

from abc import ABC, abstractmethod
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.framing import Frame

OWN_SYSTEM = 254  # ground stations use 255; two on one id cause trouble
OWN_COMPONENT = dialect.MAV_COMP_ID_MISSIONPLANNER


Ids = tuple[int, int]
"""System id and component id."""


class Talker(ABC):
    """Source of messages for the vehicle, as a state machine whose caller gives the time."""

    def source(self, own: Ids, vehicle: Ids) -> Ids:
        """Return the ids of the sender of the messages; by default the advisor's own."""
        return own

    def hear(self, frame: Frame, now_s: float) -> None:  # noqa: B027
        """Take a frame of the vehicle, or a heartbeat of any other sender on the link."""

    @abstractmethod
    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return the messages that are due. The vehicle is None if none sends yet or at present."""

    def leave(self, now_s: float) -> list[Any] | None:
        """Return the messages to send before the link is closed; None if no answer is awaited."""
        return None

    def report(self) -> list[str]:
        """Return sentences for the crew, each once."""
        return []


class Packer:
    """Packer of messages into frames, with separate sequence numbers for each sender.

    Parameters
    ----------
    key
        Signing key of 32 bytes; None for unsigned frames.
    """

    def __init__(self, key: bytes | None) -> None:
        self._key = key
        self._senders: dict[Ids, dialect.MAVLink] = {}

    def pack(self, message: Any, source: Ids, signing_time: int) -> bytes:
        """Return one frame. ``signing_time`` is in 10 us since 2015, and is raised to increase always."""
        mavlink = self._senders.get(source) or self._senders.setdefault(source, self._sender(source))
        mavlink.signing.timestamp = max(mavlink.signing.timestamp, signing_time)
        raw = bytes(message.pack(mavlink))
        mavlink.seq = (mavlink.seq + 1) % 256
        return raw

    def _sender(self, source: Ids) -> Any:
        mavlink = dialect.MAVLink(None, srcSystem=source[0], srcComponent=source[1])
        if self._key is not None:
            mavlink.signing.secret_key = self._key
            mavlink.signing.sign_outgoing = True
        return mavlink


class Heartbeat(Talker):
    """Heartbeat of a ground station once a second, from which routers and radios learn the advisor's
    address."""

    def __init__(self) -> None:
        self._next_s = float("-inf")

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return a heartbeat if one is due."""
        if now_s < self._next_s:
            return []
        self._next_s = now_s + 1.0
        return [
            dialect.MAVLink_heartbeat_message(
                dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
            )
        ]
