"""Cutter of whole MAVLink frames from the bytes of a socket or a serial line, and the signature of a frame.

Source: MAVLink guide, "Message signing". The last 13 bytes of a signed frame are a link id, a time stamp and
a signature. The time stamp has 48 bits, in 10 us since 2015-01-01, and only rises. The signature is the first
48 bits of SHA-256 over key, frame, link id and time.

By the guide, a new stream is refused if its time is more than a minute behind the local time. An autopilot
without GPS continues from its last stored time, which may be months behind. The host's clock is not used:
each sender's time is compared with that sender's newest time. Frames recorded before this session can be
replayed until their sender is heard.
"""

import hashlib
import hmac
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.checksum import AFTER, TABLE, crc16
from advisor.words.problems import ConfigurationError

for _zeros in (1, 2, 3):
    AFTER[_zeros] = AFTER[_zeros - 1] >> 8 ^ TABLE[AFTER[_zeros - 1] & 0xFF]


MAGIC_V1 = 0xFE
MAGIC_V2 = 0xFD
MAGIC = (MAGIC_V1, MAGIC_V2)
SIGNED = 0x01
SIGNATURE_LENGTH = 13
LONGEST_FRAME = 12 + 255 + SIGNATURE_LENGTH
CRC_EXTRA: Mapping[int, int] = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}
"""Seed of the checksum for every known message, by message id."""

_SEED_REMAINDERS = frozenset(TABLE.tolist())


class Frame(NamedTuple):
    """One frame as transmitted."""

    raw: bytes
    message_id: int
    sequence: int
    system: int
    component: int
    signed: bool

    @property
    def payload(self) -> bytes:
        """Payload of the frame. In MAVLink 2 its trailing zeros are cut off."""
        start = 6 if self.raw[0] == MAGIC_V1 else 10
        return self.raw[start : start + self.raw[1]]


class FrameCutter:
    """Cutter of frames from a stream of bytes that starts anywhere and may contain garbage.

    A frame of a known message must pass its checksum. The checksum is CRC-16/MCRF4XX over all bytes
    after the magic byte and over CRC_EXTRA (MAVLink serialisation guide). For an unknown message, one of 256
    random checksums fits some CRC_EXTRA. A frame of an unknown message is accepted only right after a good
    frame, and followed by another frame or by nothing.
    """

    def __init__(self, crc_extra: Mapping[int, int]) -> None:
        self._seeds = {message: bytes([extra]) for message, extra in crc_extra.items()}
        self._rest = b""
        self._in_step = True
        self.bad_crc = 0
        """Number of frames with a wrong checksum."""

    def feed(self, data: bytes) -> list[Frame]:
        """Process the next bytes, and return the frames that they complete."""
        buffer = self._rest + data if self._rest else data
        frames = []
        i, n = 0, len(buffer)
        while i < n:
            if buffer[i] not in MAGIC:
                i = self._skip(buffer, i)
                continue
            total = _frame_length(buffer, i)
            if total is None or i + total > n:
                break
            frame = self._check(buffer, i, total)
            if frame is None:
                i = self._skip(buffer, i)
                continue
            frames.append(frame)
            self._in_step = True
            i += total
        self._rest = buffer[i:]
        return frames

    def _skip(self, buffer: bytes, i: int) -> int:
        """Drop the byte at ``i``, and return the next place where a frame may start."""
        v1, v2 = buffer.find(MAGIC_V1, i + 1), buffer.find(MAGIC_V2, i + 1)
        places = [k for k in (v1, v2) if k >= 0]
        self._in_step = False
        return min(places) if places else len(buffer)

    def _check(self, buffer: bytes, i: int, total: int) -> Frame | None:
        signed = False
        if buffer[i] == MAGIC_V2:
            if buffer[i + 2] & ~SIGNED:  # a flag we must not ignore and do not know
                return None
            signed = bool(buffer[i + 2])
            message_id = buffer[i + 7] | buffer[i + 8] << 8 | buffer[i + 9] << 16
            sequence, system, component = buffer[i + 4], buffer[i + 5], buffer[i + 6]
        else:
            sequence, system, component, message_id = buffer[i + 2 : i + 6]
        end = i + total - (SIGNATURE_LENGTH if signed else 0)
        checksum = buffer[end - 2] | buffer[end - 1] << 8
        seed = self._seeds.get(message_id)
        if seed is None:
            follower = buffer[i + total : i + total + 1]
            due = self._in_step and (not follower or follower[0] in MAGIC)
            if not due or checksum ^ crc16(buffer[i + 1 : end - 2]) >> 8 not in _SEED_REMAINDERS:
                return None
        elif crc16(buffer[i + 1 : end - 2] + seed) != checksum:
            self.bad_crc += self._in_step
            return None
        return Frame(buffer[i : i + total], message_id, sequence, system, component, signed)


def _frame_length(buffer: bytes, i: int) -> int | None:
    """Return the length of the frame whose magic byte is at ``i``; None for an incomplete header."""
    if buffer[i] == MAGIC_V1:
        return 8 + buffer[i + 1] if len(buffer) > i + 1 else None
    if len(buffer) < i + 3:
        return None
    return 12 + buffer[i + 1] + (SIGNATURE_LENGTH if buffer[i + 2] & SIGNED else 0)


KEY_LENGTH = 32
EPOCH_2015_S = 1_420_070_400
RADIO_STATUS = 109
"""Message of the radios, which have no key and never sign."""

_NEW_STREAM_MAY_LAG = 6_000_000
"""Largest delay of a new stream behind its sender's other streams: one minute, in 10 us (MAVLink guide)."""

SignatureVerdict = Literal["ok", "unsigned", "forged", "replayed"]


def read_key(path: Path) -> bytes:
    """Return the key in a file. A file of 32 bytes is the key itself, and any other content is a passphrase.

    A passphrase is hashed with SHA-256 after removal of the line end. Mission Planner and MAVProxy do the
    same, so that one passphrase gives one key everywhere.

    Raises
    ------
    ConfigurationError
        The file cannot be read or is empty.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(
            f"Signing key {path}: {error.strerror}; name a file that can be read."
        ) from None
    if len(content) == KEY_LENGTH:
        return content
    phrase = content.rstrip(b"\r\n")
    if not phrase:
        raise ConfigurationError(f"Signing key {path} is empty: write 32 bytes or a passphrase into it.")
    return hashlib.sha256(phrase).digest()


def signing_time(unix_s: float) -> int:
    """Return the time stamp of a signature made now: 10 us since 2015-01-01."""
    return int((unix_s - EPOCH_2015_S) * 1e5)


class SignatureCheck:
    """Check of one frame after another, which remembers every stream's newest time against replays.

    Parameters
    ----------
    key
        Signing key of 32 bytes.
    """

    def __init__(self, key: bytes) -> None:
        self._key = key
        self._newest: dict[tuple[int, int, int], int] = {}
        """Newest time of a stream (system, component, link id), 10 us since 2015."""
        self._sender: dict[tuple[int, int], int] = {}
        """Newest time of a sender (system, component) on any of its links, 10 us since 2015."""

    def verdict(self, frame: bytes) -> SignatureVerdict:
        """Return the verdict on one whole frame.

        A time is remembered only after its signature was verified. Otherwise one forged frame from the future
        would silence the real sender.
        """
        if frame[0] != 0xFD or not frame[2] & 0x01:
            return "unsigned"
        signed_part, signature = frame[:-6], frame[-6:]
        expected = hashlib.sha256(self._key + signed_part).digest()[:6]
        if not hmac.compare_digest(expected, signature):
            return "forged"
        time = int.from_bytes(frame[-SIGNATURE_LENGTH + 1 : -6], "little")
        sender = (frame[5], frame[6])
        stream = (*sender, frame[-SIGNATURE_LENGTH])
        newest = self._sender.get(sender, 0)
        if time <= self._newest.get(stream, newest - _NEW_STREAM_MAY_LAG - 1):
            return "replayed"
        self._newest[stream] = time
        self._sender[sender] = max(newest, time)
        return "ok"
