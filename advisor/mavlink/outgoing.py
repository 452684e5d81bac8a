"""What the advisor sends, when asked to send at all: packed under its own ids, signed when it has a key."""

from typing import Any, Protocol

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.framing import Frame

OWN_SYSTEM = 254  # ground stations use 255; two on one id cause trouble
OWN_COMPONENT = dialect.MAV_COMP_ID_MISSIONPLANNER


class Talker(Protocol):
    """Something that speaks with the vehicle over a link: a state machine without a clock."""

    def hear(self, frame: Frame, now_s: float) -> None:
        """Take a frame of the vehicle, or a heartbeat of whoever else is on the link."""

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """Messages to send now; no vehicle: none was heard yet, or none is heard at present."""

    def leave(self, now_s: float) -> list[Any] | None:
        """Messages to send before the link is closed; None: nothing is left to say or to wait for."""

    def report(self) -> list[str]:
        """What the crew should know, once."""


class Packer:
    """Turns messages into frames.

    Parameters
    ----------
    system, component
        The sender's own ids.
    key
        32-byte signing key; None: frames are not signed.
    """

    def __init__(self, system: int, component: int, key: bytes | None) -> None:
        self._mavlink = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        if key is not None:
            self._mavlink.signing.secret_key = key
            self._mavlink.signing.sign_outgoing = True

    def pack(self, message: Any, signing_time: int) -> bytes:
        """One frame; ``signing_time`` in 10 us since 2015, raised when it does not rise by itself."""
        signing = self._mavlink.signing
        signing.timestamp = max(signing.timestamp, signing_time)
        raw = bytes(message.pack(self._mavlink))
        self._mavlink.seq = (self._mavlink.seq + 1) % 256
        return raw


class Heartbeat:
    """A ground station's heartbeat once a second, so that routers and radios learn our address."""

    def __init__(self) -> None:
        self._next_s = float("-inf")

    def hear(self, frame: Frame, now_s: float) -> None:
        """Nothing to hear."""

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """A heartbeat when one is due."""
        if now_s < self._next_s:
            return []
        self._next_s = now_s + 1.0
        return [
            dialect.MAVLink_heartbeat_message(
                dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
            )
        ]

    def leave(self, now_s: float) -> None:
        """Nothing is left to say."""

    def report(self) -> list[str]:
        """Nothing to report."""
        return []
