"""Messages of the advisor on a link, and their distribution to the talkers."""

from collections.abc import Callable, Iterable
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.intake import HEARTBEAT
from advisor.mavlink.link.outgoing import Ids, Packer, Talker
from advisor.mavlink.wire.framing import Frame
from advisor.mavlink.wire.signing import signing_time

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
