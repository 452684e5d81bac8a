"""Acceptance of signed frames (MAVLink 2 message signing).

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
from pathlib import Path
from typing import Literal

from advisor.mavlink.wire.framing import SIGNATURE_LENGTH
from advisor.words.problems import ConfigurationError

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
