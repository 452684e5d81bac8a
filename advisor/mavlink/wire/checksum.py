"""The checksum of MAVLink frames: CRC-16/MCRF4XX, which MAVLink calls X.25."""

from binascii import crc_hqx

import numpy as np

INITIAL = 0xFFFF


def _table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
        table.append(crc)
    return table


TABLE = np.array(_table(), dtype=np.int64)
"""Remainder of each byte under the reversed polynomial 0x8408."""

AFTER = np.array([TABLE, *np.empty((3, 256), dtype=np.int64)])
"""Shape (4, 256): remainder of each byte followed by 0, 1, 2 and 3 zero bytes.

Four bytes then take one step ("slicing-by-4", Kounavis and Berry 2005).
"""
for _zeros in (1, 2, 3):
    AFTER[_zeros] = AFTER[_zeros - 1] >> 8 ^ TABLE[AFTER[_zeros - 1] & 0xFF]

FROM_HIGH_BYTE = np.argsort(TABLE >> 8)
"""Index into ``TABLE`` of the entry with a given high byte: every high byte occurs once."""

_MIRRORED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
"""Each byte with its bits in the opposite order."""


def crc16(data: bytes, crc: int = INITIAL) -> int:
    """Return the checksum of ``data``, continued from ``crc``.

    ``binascii.crc_hqx`` has this polynomial, with the bits of bytes and remainder reversed.
    """
    return _mirrored(crc_hqx(data.translate(_MIRRORED), _mirrored(crc)))


def _mirrored(word: int) -> int:
    return _MIRRORED[word & 0xFF] << 8 | _MIRRORED[word >> 8]
