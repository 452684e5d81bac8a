"""Compiled inner loop of the frame scanner.

A stream is a sequence of records: 8 bytes of time stamp, then one frame. ``scan`` steps from record to
record. If an expected good frame is missing, the scanner tests every byte for the next frame. No decision
depends on the length of the available stream. If bytes are missing, the function stops and returns the place
to continue. Each good frame passes `arrivals`, which skips a packet that a second path repeats.
"""

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.wire.arrivals import weigh
from advisor.mavlink.wire.checksum import AFTER, FROM_HIGH_BYTE, INITIAL, TABLE
from advisor.process.compiled import kernel

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]

V1, V2 = 0xFE, 0xFD
SIGNED = 0x01
STAMP_BYTES = 8

# Columns of the table of found frames.
KIND, SOURCE, START, LENGTH, STAMP = range(5)
FOUND_COLUMNS = 5
# Entries of the running state.
AT, IN_STEP, LAST_STAMP, FRAMES, KNOWN, DAMAGED, SKIPPED = range(7)
STATE_ENTRIES = 7

# Stamps outside are no times of arrival: before the first second of 1970, after the year 2112.
_EARLIEST_US, _LATEST_US = 1_000_000, 1 << 52

_WAIT, _NONE = -1, 0


@kernel()
def _little_endian(stream: Bytes, at: int, size: int) -> int:
    value = 0
    for i in range(size):
        value |= int(np.int64(stream[at + i])) << (8 * i)
    return value


@kernel()
def _remainder(stream: Bytes, first: int, past: int) -> int:
    """Return the CRC-16 of the bytes from ``first`` to before ``past``, four bytes at a time."""
    crc = INITIAL
    at = first
    while at + 4 <= past:
        low, high = (crc ^ stream[at]) & 0xFF, crc >> 8 ^ stream[at + 1]
        crc = AFTER[3, low] ^ AFTER[2, high] ^ AFTER[1, stream[at + 2]] ^ AFTER[0, stream[at + 3]]
        at += 4
    for i in range(at, past):
        crc = crc >> 8 ^ AFTER[0, (crc ^ stream[i]) & 0xFF]
    return int(crc)


@kernel()
def _frame_length(stream: Bytes, at: int, final: bool, seeds: Ints) -> int:
    """Return the length of the good frame at ``at``; ``_NONE`` without one, or ``_WAIT`` for more bytes.

    ``seeds`` holds the CRC_EXTRA of each message id, -1 for an unknown one. The checksum of an unknown
    message fits some seed for one in 256 of the possible remainders. An unknown frame is skipped as a whole
    if another frame follows directly.
    """
    n = len(stream)
    short = _NONE if final else _WAIT
    if at >= n:
        return short
    magic = stream[at]
    if magic != V1 and magic != V2:
        return _NONE
    header = 6 if magic == V1 else 10
    if at + header > n:
        return short
    end = at + header + _little_endian(stream, at + 1, 1)
    length = end + 2 - at
    message = _little_endian(stream, at + 5, 1)
    if magic == V2:
        if stream[at + 2] & ~SIGNED:  # a flag that must not be ignored, and is not known
            return _NONE
        if stream[at + 2] & SIGNED:
            length += 13
        message = _little_endian(stream, at + 7, 3)
    if at + length > n:
        return short

    crc = _remainder(stream, at + 1, end)
    wanted = _little_endian(stream, end, 2)
    seed = seeds[message] if message < len(seeds) else -1
    if seed >= 0:
        fits = crc >> 8 ^ TABLE[(crc ^ seed) & 0xFF] == wanted
        return length if fits else _NONE
    last_step = wanted ^ crc >> 8
    if TABLE[FROM_HIGH_BYTE[last_step >> 8]] != last_step:
        return _NONE
    following = at + length + STAMP_BYTES
    if following >= n:
        return length if final else _WAIT
    return length if stream[following] == V1 or stream[following] == V2 else _NONE


@kernel()
def _stamp(stream: Bytes, at: int, last: int) -> int:
    """Return the time stamp at ``at`` in microseconds. An impossible stamp is replaced by the last good
    stamp.
    """
    stamp = 0
    for i in range(at, at + STAMP_BYTES):
        stamp = stamp << 8 | int(np.int64(stream[i]))
    return stamp if _EARLIEST_US <= stamp < _LATEST_US else last


@kernel()
def scan(
    stream: Bytes,
    final: bool,
    kinds: Ints,
    seeds: Ints,
    state: Ints,
    senders: Ints,
    packets: Ints,
    newest: Ints,
    frames: Ints,
) -> tuple[int, int]:
    """Find the good frames in a part of the stream.

    Parameters
    ----------
    stream : shape (n,)
        Available bytes, from the end of the last frame (or 8 bytes before the reached place).
    final : bool
        Whether the stream ends here, so that an incomplete last frame is garbage.
    kinds, seeds : shape (largest known id + 1,)
        Caller's number of each wanted message or -1, and its CRC_EXTRA or -1, by message id.
    state : shape (STATE_ENTRIES,)
        State that is kept from call to call.
    senders, packets, newest
        State that is kept from call to call, see `advisor.mavlink.wire.arrivals`. The first is indexed by
        ``system << 8 | component``.
    frames : shape (at least n // 8 + 1, FOUND_COLUMNS)
        Table that receives one row for each wanted frame.

    Returns
    -------
    rows : int
        Number of rows of ``frames`` in use.
    keep : int
        Index of the first byte that the next call needs again.
    """
    n = len(stream)
    rows = 0
    at, in_step, end = int(state[AT]), bool(state[IN_STEP]), 0
    while True:
        length = _frame_length(stream, at, final, seeds)
        if length == _WAIT or (at >= n and not in_step):
            break
        if length == _NONE:
            if in_step:
                state[DAMAGED] += end < n
                in_step = False
                at = end
            else:
                at += 1
                state[SKIPPED] += 1
            continue

        # Sequence, system, component and message id are contiguous in either version.
        v1 = stream[at] == V1
        address = at + (2 if v1 else 4)
        source = _little_endian(stream, address + 1, 1) << 8 | _little_endian(stream, address + 2, 1)
        message = _little_endian(stream, address + 3, 1 if v1 else 3)
        if at - end >= STAMP_BYTES:
            state[LAST_STAMP] = _stamp(stream, at - STAMP_BYTES, int(state[LAST_STAMP]))
        state[FRAMES] += 1
        checksum = _little_endian(stream, at + length - (2 if v1 or not stream[at + 2] & SIGNED else 15), 2)
        kept = weigh(
            senders,
            packets,
            newest,
            source,
            _little_endian(stream, address, 1),
            source << 48 | message << 25 | length << 16 | checksum,
            int(state[LAST_STAMP]),
        )
        if message < len(kinds) and seeds[message] >= 0:
            state[KNOWN] += 1
            if kept and kinds[message] >= 0:
                frames[rows, KIND] = kinds[message]
                frames[rows, SOURCE] = source
                frames[rows, START] = at
                frames[rows, LENGTH] = length
                frames[rows, STAMP] = state[LAST_STAMP]
                rows += 1
        end = at + length
        at = end + STAMP_BYTES
        in_step = True

    keep = end if in_step else max(end, at - STAMP_BYTES)
    state[AT], state[IN_STEP] = at - keep, in_step
    return rows, keep


@kernel()
def copy_payloads(stream: Bytes, starts: Ints, payloads: Bytes) -> None:
    """Copy the payload of each frame into its row. Zeros that MAVLink 2 cut off remain zeros.

    Parameters
    ----------
    stream : shape (n,)
    starts : shape (m,)
        Positions of the frames.
    payloads : shape (m, size)
        Array of zeros for the payloads.
    """
    m, size = payloads.shape
    for row in range(m):
        start = int(starts[row])
        body = start + (6 if stream[start] == V1 else 10)
        for i in range(min(size, _little_endian(stream, start + 1, 1))):
            payloads[row, i] = stream[body + i]
