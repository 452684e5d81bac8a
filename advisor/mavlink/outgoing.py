"""What the advisor sends, when asked to send at all: packed under its own ids, signed when it has a key."""

from typing import Any, Protocol

from pymavlink.dialects.v20 import ardupilotmega as dialect

OWN_SYSTEM = 254  # ground stations use 255; two on one id cause trouble
OWN_COMPONENT = dialect.MAV_COMP_ID_MISSIONPLANNER


class Talker(Protocol):
    """Something that speaks with the vehicle over a link, as a state machine without a clock."""

    @property
    def listens_to(self) -> frozenset[int]:
        """Ids of the messages it wants to hear from the vehicle."""

    def hear(self, message: Any, now_s: float) -> None:
        """Take a decoded message of the vehicle."""

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """Messages to send now; None: no vehicle was heard yet."""


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

    listens_to: frozenset[int] = frozenset()

    def __init__(self) -> None:
        self._next_s = float("-inf")

    def hear(self, message: Any, now_s: float) -> None:
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
