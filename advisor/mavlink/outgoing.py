"""What the advisor sends, when asked to send at all: packed under its own ids, signed when it has a key."""

from abc import ABC, abstractmethod
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.framing import Frame

OWN_SYSTEM = 254  # ground stations use 255; two on one id cause trouble
OWN_COMPONENT = dialect.MAV_COMP_ID_MISSIONPLANNER


Ids = tuple[int, int]
"""System and component."""


class Talker(ABC):
    """Something that speaks with the vehicle over a link: a state machine without a clock."""

    def source(self, own: Ids, vehicle: Ids) -> Ids:
        """Return ids under which the messages go out: the advisor's own."""
        return own

    def hear(self, frame: Frame, now_s: float) -> None:  # noqa: B027
        """Take a frame of the vehicle, or a heartbeat of whoever else is on the link."""

    @abstractmethod
    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return messages to send now; no vehicle: none was heard yet, or none is heard at present."""

    def leave(self, now_s: float) -> list[Any] | None:
        """Return messages to send before the link is closed; None: nothing is left to say or to wait for."""
        return None

    def report(self) -> list[str]:
        """What the crew should know, once."""
        return []


class Packer:
    """Turns messages into frames, each sender's with sequence numbers of their own.

    Parameters
    ----------
    key
        32-byte signing key; None: frames are not signed.
    """

    def __init__(self, key: bytes | None) -> None:
        self._key = key
        self._senders: dict[Ids, dialect.MAVLink] = {}

    def pack(self, message: Any, source: Ids, signing_time: int) -> bytes:
        """Return one frame; ``signing_time`` in 10 us since 2015, raised when it does not rise by itself."""
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
    """A ground station's heartbeat once a second, so that routers and radios learn our address."""

    def __init__(self) -> None:
        self._next_s = float("-inf")

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return a heartbeat when one is due."""
        if now_s < self._next_s:
            return []
        self._next_s = now_s + 1.0
        return [
            dialect.MAVLink_heartbeat_message(
                dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
            )
        ]
