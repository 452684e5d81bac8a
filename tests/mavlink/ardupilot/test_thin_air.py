"""The indicated air speed of a ``.bin`` becomes the true one by the height that its GPS records state."""

import struct
from pathlib import Path

import pytest

from advisor.flight.signals.record import Channel
from advisor.mavlink.logs.logs import read_whole_log
from tests.heard import hear

LOG = Path(__file__).parents[2] / "cases" / "base.bin"
"""One manoeuvre; only its GPS records, of format ``QBBIHBcLLeffffB``, state a height: 100 m."""
_ALT_AT = 3 + 8 + 1 + 1 + 4 + 2 + 1 + 2 + 4 + 4
_HEAD = b"\xa3\x95"


def airspeed_at(height_m: float, folder: Path) -> Channel:
    """Return the air speed of the manoeuvre, flown so high above mean sea level."""
    log = bytearray(LOG.read_bytes())
    at = log.index(b"GPS\0QBBIHBcLLeffffB")
    gps = _HEAD + bytes([log[at - 2]])
    where = log.find(gps)
    while where >= 0:
        struct.pack_into("<i", log, where + _ALT_AT, round(100.0 * height_m))
        where = log.find(gps, where + 3)
    high = folder / "high.bin"
    high.write_bytes(log)
    (maneuver,) = hear(read_whole_log(high)).maneuvers
    return maneuver.channels["airspeed"]


@pytest.mark.parametrize(("height_m", "ratio"), [(100.0, 1.0048), (3000.0, 1.1607)])
def test_the_height_of_gps_makes_an_indicated_air_speed_true(height_m, ratio, tmp_path: Path) -> None:
    airspeed = airspeed_at(height_m, tmp_path)
    assert airspeed.source.endswith("true by the height")
    assert airspeed.gain == pytest.approx(ratio, abs=2e-4)


def test_a_barometer_without_a_climb_rate_keeps_its_pressure(tmp_path: Path) -> None:
    body = struct.Struct("<QBff")
    names = (b"BARO".ljust(4, b"\0"), b"QBff".ljust(16, b"\0"), b"TimeUS,I,Alt,Press".ljust(64, b"\0"))
    form = _HEAD + bytes([128, 250, 3 + body.size]) + b"".join(names)
    readings = [_HEAD + bytes([250]) + body.pack(1000 * k, 0, 3000.0, 70_110.0) for k in range(10)]
    log = tmp_path / "baro.bin"
    log.write_bytes(form + b"".join(readings) + LOG.read_bytes())
    heard = [c for batch in read_whole_log(log) for c in batch if c.name == "SCALED_PRESSURE"]
    pressures = [value for c in heard for value in c.fields["press_abs"].tolist()]
    assert pressures == pytest.approx([701.1] * 10)
