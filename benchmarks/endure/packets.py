"""Packets of a telemetry log, with values that can be changed, and the log written again."""

import re
import struct
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.checksum import crc16
from advisor.mavlink.wire.framing import CRC_EXTRA

_STAMP = 8
_SIGNED = 1
_CLOCKS = {"time_boot_ms": 1e3, "time_usec": 1e6}
"""Clocks of the vehicle, and their ticks a second."""


class Packet(NamedTuple):
    """One message of a log."""

    arrival_us: int
    number: int
    """Number of the message."""
    sender: bytes
    """System and component."""
    payload: bytes
    """Payload without truncated zeros, as long as the message's definition says."""


Flight = tuple[Packet, ...]


def read(log: bytes) -> Flight:
    """Return all packets of a log. Bytes of no packet and messages of another dialect are left out."""
    found, at = [], 0
    while at + _STAMP + 12 < len(log):
        length, packet = _packet(log, at)
        at += length
        if packet is not None:
            found.append(packet)
    return tuple(found)


def _packet(log: bytes, at: int) -> tuple[int, Packet | None]:
    """Return how many bytes to go on, and the packet at a place of the log if one is there."""
    start = at + _STAMP
    if log[start] not in (0xFD, 0xFE):
        return 1, None
    size, two = log[start + 1], log[start] == 0xFD
    head = 10 if two else 6
    end = start + head + size
    number = int.from_bytes(log[start + 7 : start + 10], "little") if two else log[start + 5]
    if number not in CRC_EXTRA or end + 2 > len(log):
        return 1, None
    crc = crc16(log[start + 1 : end] + bytes([CRC_EXTRA[number]]))
    if crc != int.from_bytes(log[end : end + 2], "little"):
        return 1, None
    sender = log[start + 5 : start + 7] if two else log[start + 3 : start + 5]
    whole = dialect.mavlink_map[number].unpacker.size
    payload = log[start + head : end].ljust(whole, b"\0")[:whole]
    signature = 13 if two and log[start + 2] & _SIGNED else 0
    (arrival_us,) = struct.unpack_from(">Q", log, at)
    return end + 2 + signature - at, Packet(arrival_us, number, sender, payload)


def written(flight: Iterable[Packet]) -> bytes:
    """Return a log of unsigned MAVLink 2 packets, numbered anew."""
    out, sequence = bytearray(), 0
    for arrival_us, number, sender, payload in flight:
        short = payload.rstrip(b"\0") or payload[:1]
        body = bytes([len(short), 0, 0, sequence]) + sender + number.to_bytes(3, "little") + short
        crc = crc16(body + bytes([CRC_EXTRA[number]])).to_bytes(2, "little")
        out += struct.pack(">Q", arrival_us % 2**64) + b"\xfd" + body + crc
        sequence = (sequence + 1) % 256
    return bytes(out)


def seconds(flight: Sequence[Packet]) -> float:
    """Return the time from the first packet to the last, s."""
    return 1e-6 * (flight[-1].arrival_us - flight[0].arrival_us) if flight else 0.0


@cache
def fields(number: int) -> tuple[str, ...]:
    """Return the names of a message's fields in their order on the wire; none where a field is an array."""
    message = dialect.mavlink_map[number]
    names = tuple(message.ordered_fieldnames)
    return names if len(message.unpacker.unpack(bytes(message.unpacker.size))) == len(names) else ()


def name(number: int) -> str:
    """Return the name of a message."""
    return str(dialect.mavlink_map[number].msgname)


def value(packet: Packet, field: str) -> float:
    """Return the number in a field."""
    at = fields(packet.number).index(field)
    return float(dialect.mavlink_map[packet.number].unpacker.unpack(packet.payload)[at])


def changed(packet: Packet, field: str, change: Callable[[float], float]) -> Packet:
    """Return a packet with another number in a field, clipped to the field's range. An integer has no NaN:
    in its place stands the largest number, by which MAVLink says "unknown"."""
    unpacker, at = dialect.mavlink_map[packet.number].unpacker, fields(packet.number).index(field)
    values = list(unpacker.unpack(packet.payload))
    values[at] = _fitting(_kind(packet.number, at), change(float(values[at])))
    return packet._replace(payload=unpacker.pack(*values))


@cache
def _kind(number: int, at: int) -> str:
    """Return the letter by which `struct` names the type of a field."""
    return re.findall(r"\d*([a-zA-Z])", dialect.mavlink_map[number].unpacker.format)[at]


def _fitting(kind: str, number: float) -> float:
    if kind == "d":
        return number
    if kind == "f":
        return number if number != number else min(max(number, -3.4e38), 3.4e38)
    bits = 8 * struct.calcsize("<" + kind)
    low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if kind.islower() else (0, 2**bits - 1)
    return high if number != number else min(max(round(number), low), high)


def moved(packet: Packet, clock: Callable[[float], float]) -> Packet:
    """Return a packet whose stamp and vehicle clock show other times, by a function of seconds.

    A clock that reaches the end of its range begins again with zero.
    """
    packet = packet._replace(arrival_us=round(1e6 * clock(1e-6 * packet.arrival_us)))
    for field, ticks in _CLOCKS.items():
        if field in fields(packet.number):
            bits = 8 * struct.calcsize("<" + _kind(packet.number, fields(packet.number).index(field)))
            packet = changed(
                packet, field, lambda t, ticks=ticks, bits=bits: round(ticks * clock(t / ticks)) % 2**bits
            )
    return packet
