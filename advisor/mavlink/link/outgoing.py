"""Messages that the advisor sends: packed, signed if a key is given, and distributed to talkers."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.intake import HEARTBEAT
from advisor.mavlink.wire.framing import Frame, signing_time

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


Send = Callable[[bytes], bool]
"""Function that sends one frame, and returns False without a receiver."""


class Conversation:
    """All talkers of one link, with their messages packed under the talkers' ids.

    Parameters
    ----------
    key
        Signing key of 32 bytes; None for unsigned frames.
    """

    def __init__(self, talkers: Iterable[Talker], own: Ids, key: bytes | None) -> None:
        self._talkers = list(talkers)
        self._own = own
        self._packer = Packer(key)

    def join(self, talker: Talker) -> None:
        self._talkers.append(talker)

    def hear(self, frames: list[Frame], vehicle: Ids | None, now_s: float) -> list[str]:
        """Pass the vehicle's frames and every heartbeat to the talkers, and return new sentences for the
        crew."""
        system = vehicle[0] if vehicle is not None else None
        heard = [frame for frame in frames if frame.system == system or frame.message_id == HEARTBEAT]
        said = []
        for talker in self._talkers:
            for frame in heard:
                talker.hear(frame, now_s)
            said += talker.report()
        return said

    def speak(
        self, vehicle: Ids | None, reachable: bool, now_s: float, unix_s: float, send: Send
    ) -> list[bytes]:
        """Send the due messages, and return the frames that were sent.

        Parameters
        ----------
        vehicle
            Followed vehicle. None before the first heartbeat.
        reachable
            Whether the vehicle receives messages.
        now_s, unix_s
            Monotonic time of the reader, and the host's time since 1970, s.
        send
            Function that sends one frame.
        """
        hearing = vehicle if reachable else None
        return [
            raw
            for talker in self._talkers
            for raw in self._send(talker, talker.speak(hearing, now_s), vehicle, unix_s, send)
        ]

    def leave(self, vehicle: Ids | None, now_s: float, unix_s: float, send: Send) -> list[bytes] | None:
        """Send the talkers' last messages before the link is closed; None if no answer is awaited."""
        last = [talker.leave(now_s) for talker in self._talkers]
        if all(messages is None for messages in last):
            return None
        return [
            raw
            for talker, messages in zip(self._talkers, last, strict=True)
            for raw in self._send(talker, messages or [], vehicle, unix_s, send)
        ]

    def note(self, text: bytes, unix_s: float) -> bytes:
        """Return a frame with a text of the advisor that is only recorded in its own stream. The frame is not
        sent."""
        message = dialect.MAVLink_statustext_message(dialect.MAV_SEVERITY_INFO, text)
        return self._packer.pack(message, self._own, signing_time(unix_s))

    def _send(
        self, talker: Talker, messages: Iterable[Any], vehicle: Ids | None, unix_s: float, send: Send
    ) -> list[bytes]:
        source = talker.source(self._own, vehicle or self._own)
        frames = [self._packer.pack(message, source, signing_time(unix_s)) for message in messages]
        return [raw for raw in frames if send(raw)]
