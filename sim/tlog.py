"""Reader of telemetry logs for a replay."""

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

STAMP = 8
MAGIC_1, MAGIC_2 = 0xFE, 0xFD
HEADER_1, HEADER_2, CHECKSUM, SIGNATURE = 6, 10, 2, 13


def read_tlog(path: Path, wanted: Collection[str]) -> Iterator[tuple[float, Any]]:
    """Yield (host time in s, message) for the wanted message names. Damaged stretches are skipped.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    data = path.read_bytes()
    parser = mavlink.MAVLink(None)
    place = 0
    while place + STAMP + HEADER_2 < len(data):
        frame = place + STAMP
        if data[frame] == MAGIC_2:
            signed = SIGNATURE if data[frame + 2] & 1 else 0
            length = HEADER_2 + data[frame + 1] + CHECKSUM + signed
        elif data[frame] == MAGIC_1:
            length = HEADER_1 + data[frame + 1] + CHECKSUM
        else:
            place += 1
            continue
        try:
            message = parser.decode(bytearray(data[frame : frame + length]))
        except mavlink.MAVError:
            # Not a frame after all. The search continues at the next byte, else a false start would hide true
            # frames.
            place += 1
            continue
        if message.get_type() in wanted:
            yield int.from_bytes(data[place:frame], "big") / 1e6, message
        place = frame + length
