"""Named values and records under two type numbers, in ArduPilot's own log."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Alpha
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear_log
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.dataflash_writer import rewritten

VANE = {
    "NVAL": ("QINfBB", "TimeUS,TimeBootMS,Name,Value,SSys,SCom"),
    "NVF": ("QNf", "TimeUS,Name,Value"),
}


def vane_deg(t):
    return 3.0 + np.sin(t)


def with_vane(record, name=b"alpha"):
    return rewritten(
        dataflash_flight(30.0), add={record: (*VANE[record], lambda t: {"Name": name, "Value": vane_deg(t)})}
    )


def flown(path, content, source):
    path.write_bytes(content)
    heard = hear_log(path, Aircraft(alpha=Alpha(source=source)), keep_all=True)
    return heard.stream, [notice.text for notice in heard.notices]


@pytest.mark.parametrize("record", VANE)
def test_a_vanes_named_values_in_an_autopilots_own_log_are_the_angle_of_attack(tmp_path: Path, record):
    stream, said = flown(tmp_path / "a.bin", with_vane(record), "named_value:alpha")
    alpha = stream.power_ons[0].channels["alpha"]
    assert alpha.source == "NAMED_VALUE_FLOAT.alpha"
    assert np.degrees(alpha.y) == pytest.approx(vane_deg(alpha.t), abs=1e-3)
    assert alpha.rate_hz == pytest.approx(25.0, rel=0.01)
    assert not any("alpha.source" in text for text in said)


def test_a_source_that_is_not_there_is_said_with_the_names_that_are(tmp_path: Path):
    _, said = flown(tmp_path / "a.bin", with_vane("NVAL", b"boom"), "named_value:alpha")
    (one,) = (text for text in said if "alpha.source" in text)
    assert "named_value:alpha, which is not in this record; the named values are boom" in one


def test_a_message_that_was_asked_for_and_never_came_is_said(tmp_path: Path):
    _, said = flown(tmp_path / "a.bin", rewritten(dataflash_flight(10.0), drop={"AOA"}), "aoa_ssa")
    assert any("asks for aoa_ssa, which is not in this record" in text for text in said)


def test_records_of_one_name_under_two_type_numbers_all_count(tmp_path: Path):
    """Each second RCOU stands under another number."""
    log = dataflash_flight(20.0)
    once, twice = tmp_path / "once.bin", tmp_path / "twice.bin"
    once.write_bytes(rewritten(log))
    twice.write_bytes(doubled(rewritten(log), b"RCOU", 60))
    found = [
        next(c for batch in open_log(path) for c in batch if c.name == "SERVO_OUTPUT_RAW")
        for path in (once, twice)
    ]
    assert len(found[0]) > 200
    assert np.array_equal(found[0].fields["time_usec"], found[1].fields["time_usec"])
    assert np.array_equal(found[0].fields["servo2_raw"], found[1].fields["servo2_raw"])


def doubled(log: bytes, name: bytes, number: int) -> bytes:
    """Define a record under a second number, and move each second of its records there."""
    at = log.index(b"\xa3\x95\x80", log.index(name) - 8)
    definition = log[at : at + 89]
    old, length = definition[3], definition[4]
    parts = log.split(b"\xa3\x95")
    counted = 0
    for k, part in enumerate(parts):
        if part[:1] == bytes([old]) and len(part) == length - 2:
            counted += 1
            parts[k] = bytes([number]) + part[1:] if counted % 2 else part
    second = b"\x80" + bytes([number]) + definition[4:]
    return b"\xa3\x95".join([parts[0], second, *parts[1:]])
