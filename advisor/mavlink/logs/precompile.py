"""Compile the log readers once: ``python -m advisor.mavlink.logs.precompile``, when installing.

numba keeps its machine code next to the modules, so that later starts only load it.
"""

import numpy as np

from advisor.mavlink.records.record_scan import gather, known_lengths, scan_records
from advisor.mavlink.wire.checksum import crc16
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.frames import FrameScanner


def warm_up() -> None:
    """Read one heartbeat and an empty dataflash log."""
    heartbeat = DEFINITIONS["HEARTBEAT"]
    size = heartbeat.layout.itemsize
    head = bytes([size, 0, 1, 1, heartbeat.id]) + bytes(size)
    checksum = crc16(head + bytes([heartbeat.crc_extra]))
    FrameScanner().feed(bytes(8) + b"\xfe" + head + checksum.to_bytes(2, "little"))
    nothing = np.empty(0, dtype=np.uint8)
    no_places = np.empty(0, dtype=np.int64)
    scan_records(nothing, no_places, known_lengths(), True)
    gather(nothing, no_places, np.empty((0, 1), dtype=np.uint8))


if __name__ == "__main__":
    warm_up()
