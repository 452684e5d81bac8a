"""A stream that keeps everything has every sample of every power-on; another has none."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.power_on import PowerOn
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from tests.flights import SHIPPED, TWO, recorded


def heard(log: Path, keep_all: bool = True) -> tuple[FlightStream, list[Columns]]:
    stream, columns = FlightStream(Aircraft(), keep_all=keep_all), list(open_log(log))
    for batch in columns:
        stream.feed(batch)
    stream.finish()
    return stream, [column for batch in columns for column in batch]


def test_every_sample_of_a_flight_longer_than_the_memory_of_a_stream_is_kept() -> None:
    stream, columns = heard(SHIPPED / "bundled-demo.tlog")
    (power_on,) = stream.power_ons
    sent = np.concatenate([c.fields["pitchspeed"] for c in columns if c.name == "ATTITUDE"])
    q = power_on.channels["q"]
    assert q.t[-1] - q.t[0] > 120.0
    assert len(q) == len(sent) - 1, "the first comes before the vehicle's first heartbeat"
    np.testing.assert_array_equal(q.y, sent[1:])


def test_a_log_of_two_power_ons_gives_two_each_with_its_own_times(tmp_path: Path) -> None:
    log = tmp_path / "two.tlog"
    log.write_bytes(
        recorded("linear", 1.0, 11, TWO).read_bytes() + recorded("linear", 1.0, 12, TWO).read_bytes()
    )
    stream, _ = heard(log)
    assert [one.boot for one in stream.power_ons] == [0, 1]
    for power_on in stream.power_ons:
        t = power_on.channels["q"].t
        assert t[0] < 25.0
        assert np.all(np.diff(t) > 0.0)


def test_without_being_asked_a_stream_keeps_no_power_on() -> None:
    stream, _ = heard(recorded("linear", 1.0, 11, TWO), keep_all=False)
    assert stream.power_ons == []


def test_arrivals_are_those_of_the_clock_in_a_stretch_of_time() -> None:
    power_on = PowerOn(0, {}, np.array([3, 8, 20, 31]), np.array([1.0, 2.0, 3.0, 4.0]))
    assert power_on.arrivals(2.0, 3.5) == (8, 20)
    with pytest.raises(ValueError, match="no time of this stretch"):
        power_on.arrivals(4.5, 5.0)
