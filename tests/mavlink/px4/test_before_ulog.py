"""A log of PX4 before 2017 has ArduPilot's container and other units."""

import struct
from pathlib import Path

import pytest

from advisor.mavlink.logs.logs import open_log
from advisor.words.problems import UnusableInputError

FORMATS = {"TIME": (129, "Q", "StartTime"), "ATT": (2, "fff", "Roll,Pitch,Yaw")}


def test_a_log_of_px4_before_2017_is_refused_by_name(tmp_path: Path) -> None:
    log = []
    for name, (number, form, columns) in FORMATS.items():
        length = 3 + struct.calcsize("<" + form)
        body = struct.pack("<BB4s16s64s", number, length, name.encode(), form.encode(), columns.encode())
        log.append(b"\xa3\x95\x80" + body)
    log.append(b"\xa3\x95\x81" + struct.pack("<Q", 1_000_000))
    log.append(b"\xa3\x95\x02" + struct.pack("<fff", 0.0, 0.1, 0.0))
    path = tmp_path / "flight.px4log"
    path.write_bytes(b"".join(log))
    with pytest.raises(UnusableInputError) as refused:
        list(open_log(path, ["ATTITUDE"]))
    assert refused.value.problem.code == "px4log"
