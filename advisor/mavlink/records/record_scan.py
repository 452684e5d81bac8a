"""Records in the bytes of an ArduPilot log, window by window, so that no file must fit into memory.

A record is two bytes of header, a type, and its fields. Records carry no checksum. A record is accepted only
if another header, or the end of the file, follows directly.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import IntArray
from advisor.process.compiled import kernel

HEADER = b"\xa3\x95"
_HEADER_0, _HEADER_1 = HEADER
FMT = 0x80
"""Type of the records that define the other types."""
FMT_LENGTH = 89
WINDOW_BYTES = 4 << 20
"""Number of bytes of a file that are processed together. Records that are read need six times as much
memory."""

Bytes = NDArray[np.uint8]


class Window(NamedTuple):
    """Consecutive bytes of a file, and the records that begin in them."""

    stream: Bytes
    starts: IntArray
    """Position of each record in ``stream``."""
    offset: int
    """Position of ``stream`` in the file."""


def windows(path: Path) -> Iterator[Window]:
    """Yield all records of a file, window by window; at least one window, which may be empty."""
    lengths = known_lengths()
    rest = np.empty(0, dtype=np.uint8)
    offset = 0
    with path.open("rb") as file:
        while True:
            new = np.fromfile(file, dtype=np.uint8, count=WINDOW_BYTES)
            is_last = len(new) < WINDOW_BYTES
            stream = np.concatenate([rest, new])
            starts = np.empty(len(stream) // 4 + 1, dtype=np.int64)
            count, past = scan_records(stream, starts, lengths, is_last)
            yield Window(stream, starts[:count], offset)
            if is_last:
                return
            rest, offset = stream[past:].copy(), offset + past


def known_lengths() -> IntArray:
    """Return the record length of each type before any definition is read, shape (256,); 0 if unknown."""
    lengths = np.zeros(256, dtype=np.int64)
    lengths[FMT] = FMT_LENGTH
    return lengths


def bodies(stream: Bytes, starts: IntArray, width: int) -> Bytes:
    """Return the bytes behind the type of each record, shape (n, width)."""
    rows = np.empty((len(starts), width), dtype=np.uint8)
    gather(stream, starts + 3, rows)
    return rows


@kernel()
def gather(stream: Bytes, places: IntArray, rows: Bytes) -> None:
    """Copy the bytes that begin at each of ``places`` into a row of ``rows``."""
    for i in range(len(places)):
        rows[i] = stream[places[i] : places[i] + rows.shape[1]]


@kernel()
def scan_records(stream: Bytes, starts: IntArray, lengths: IntArray, is_last: bool) -> tuple[int, int]:
    """Find the records in a stream of bytes.

    Parameters
    ----------
    stream
        Bytes of the file.
    starts
        Array that receives the positions of the records.
    lengths : shape (256,)
        Length of a record of each type; FMT records change them.
    is_last
        Whether the file ends with these bytes.

    Returns
    -------
    Number of the records, and the position behind the last byte that needs no further ones.
    """
    n = len(stream)
    count = 0
    at = 0
    while at + 3 <= n:
        if stream[at] == _HEADER_0 and stream[at + 1] == _HEADER_1:
            length = int(lengths[stream[at + 2]])
            end = at + length
            if length > 3 and end + 1 >= n and not is_last:
                break
            follows = end + 1 < n and stream[end] == _HEADER_0 and stream[end + 1] == _HEADER_1
            if length > 3 and (end == n or follows):
                if stream[at + 2] == FMT:
                    lengths[stream[at + 3]] = stream[at + 4]
                starts[count] = at
                count += 1
                at = end
                continue
        at += 1
    return count, at
