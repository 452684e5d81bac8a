"""A track keeps what it is asked to keep, whatever its buffer holds at the start."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import BestRate, ChannelStatus, Extremes, PowerOn, Track
from advisor.flight.signals.tracks import Tracks
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from tests.flights import SHIPPED, TWO, recorded


def filled(*sizes, keep_from_s=None):
    """Return a track of samples every 0.1 s, arrived in pieces of these sizes; a value is its number."""
    track, sent = Track("bank", "ATTITUDE.roll", "measured"), 0
    for size in sizes:
        number = np.arange(sent, sent + size)
        track.append(0.1 * number, number.astype(float), number)
        sent += size
        if keep_from_s is not None:
            track.forget(keep_from_s)
    return track


@pytest.mark.parametrize("sizes", [(1000,), (1024, 1), (1000, 500, 3000)])
def test_every_sample_is_kept_while_nothing_is_to_be_forgotten(sizes):
    kept = filled(*sizes).cut(-1.0, 1e6)
    assert kept.y.tolist() == list(range(sum(sizes)))


def test_samples_before_the_wanted_time_are_dropped_when_room_is_needed():
    assert len(filled(900, 100, keep_from_s=50.0).cut(-1.0, 1e6)) == 1000
    kept = filled(900, 500, keep_from_s=49.95).cut(-1.0, 1e6)
    assert kept.y.tolist() == list(range(500, 1400))


def test_a_duplicate_counts_once_and_a_late_sample_in_its_place():
    track = Track("bank", "ATTITUDE.roll", "measured")
    track.append(np.array([0.0, 0.2, 0.1, 0.2]), np.array([1.0, 3.0, 2.0, 9.0]), np.arange(4))
    assert track.cut(0.0, 1.0).y.tolist() == [1.0, 2.0, 3.0]
    assert track.cut(0.0, 1.0, up_to_order=1).y.tolist() == [1.0, 3.0]
    assert track.status.largest_gap_s == pytest.approx(0.2)


def test_the_status_does_not_depend_on_how_often_somebody_asks():
    asked, silent = (Track("bank", "ATTITUDE.roll", "measured") for _ in range(2))
    t = np.cumsum(np.random.default_rng(1).exponential(0.1, 5000)) - 0.3 * (np.arange(5000) % 7 == 0)
    for k in range(0, 5000, 3):
        part = slice(k, k + 3)
        for track in (asked, silent):
            track.append(t[part], np.sin(t[part]), np.arange(5000)[part])
            track.forget(t[k] - 30.0)
        assert asked.status.last_s == t[: k + 3].max()
    assert asked.status == silent.status
    assert np.array_equal(asked.extremes.course.low, silent.extremes.course.low)


def test_the_better_rate_and_the_wider_range_of_two_boots_stand_for_one_source():
    one = ChannelStatus("ATTITUDE.roll", "measured", 10.0, 0.1, 5.0, best_hz=25.0, lowest=-1.0, highest=2.0)
    other = ChannelStatus("ATTITUDE.roll", "measured", 20.0, 0.1, 5.0, best_hz=20.0, lowest=-3.0, highest=1.0)
    both = one.at_best(other)
    assert (both.rate_hz, both.lowest, both.highest) == (25.0, -3.0, 2.0)


@pytest.mark.parametrize("cuts", [[5], [1, 2, 3, 4], [3]])
def test_the_newest_value_is_that_of_the_latest_stamp_however_the_samples_come(cuts: list[int]) -> None:
    t = np.array([1.0, 2.0, 3.0, 3.0, 2.5])
    y = np.array([10.0, 20.0, 30.0, 31.0, 25.0])
    track = Track("bank", "ATTITUDE.roll", "measured")
    for part in np.split(np.arange(5), cuts):
        track.append(t[part], y[part], part.astype(np.int64))
    assert track.status.newest == 30.0


def test_an_angle_of_attack_derived_from_the_climb_rate_shows_no_climb_rate() -> None:
    tracks = Tracks("derived")
    t, order = np.arange(0.0, 4.0, 0.1), np.arange(40)
    for channel, source, value in (
        ("climb_rate", "VFR_HUD.climb", 3.0),
        ("airspeed", "VFR_HUD.airspeed", 25.0),
        ("theta", "ATTITUDE.pitch", 0.1),
    ):
        tracks.append(Decoded(channel, source, "measured", t, np.full(40, value), order))
    assert tracks.statuses()["climb_rate"].newest == 3.0
    assert np.isnan(tracks.statuses()["alpha"].newest)


def rate(*batches: np.ndarray) -> float:
    best = BestRate()
    for t in batches:
        best.add(t)
    return best.rate_hz


def test_a_rate_cut_at_the_end_of_a_log_does_not_lower_it() -> None:
    assert rate(np.arange(0.0, 60.0, 0.02), np.arange(60.0, 120.0, 0.5)) == pytest.approx(50.0, rel=1e-3)


def test_packets_that_come_twice_count_once() -> None:
    t = np.arange(3.0, 40.0, 0.2)
    assert rate(np.repeat(t, 2)) == rate(t) == pytest.approx(5.0)


def test_batches_make_no_difference() -> None:
    t = np.sort(np.random.default_rng(1).uniform(0.0, 35.0, 900))
    assert rate(*np.array_split(t, 37)) == rate(t)


def test_a_short_log_has_the_rate_of_what_there_is() -> None:
    assert rate(np.arange(7.0, 9.0, 0.1)) == pytest.approx(10.0)
    assert np.isnan(rate(np.array([1.0])))
    assert np.isnan(rate(np.array([])))


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


@pytest.mark.parametrize("seconds", [30.0, 4000.0])
def test_a_single_peak_is_seen_however_long_the_flight(seconds: float) -> None:
    t = np.arange(0.0, seconds, 0.1)
    y = np.zeros(len(t))
    y[len(t) // 3] = 5.0
    found = Extremes()
    for part in np.array_split(np.arange(len(t)), 50):
        found.add(t[part], y[part])
    course = found.course
    assert len(course.t) <= 600
    assert course.high.max() == 5.0
    assert abs(course.t[np.argmax(course.high)] - t[len(t) // 3]) < seconds / 100.0
    assert course.low.max() == 0.0


def test_the_batches_do_not_matter() -> None:
    random = np.random.default_rng(1)
    t, y = np.sort(random.uniform(10.0, 900.0, 5000)), random.normal(size=5000)
    whole, parts = Extremes(), Extremes()
    whole.add(t, y)
    for k in range(0, 5000, 7):
        parts.add(t[k : k + 7], y[k : k + 7])
    assert np.array_equal(whole.course.high, parts.course.high)
    assert np.array_equal(whole.course.low, parts.course.low)


def test_a_silence_is_a_gap() -> None:
    found = Extremes()
    found.add(np.array([0.0, 0.1, 60.0]), np.array([1.0, 2.0, 3.0]))
    assert len(found.course.t) == 2


def test_a_stamp_that_rounds_up_to_the_end_has_a_place() -> None:
    begin_s = 33.586
    stamp_s = np.nextafter(begin_s + 150.0, 0.0)
    found = Extremes()
    found.add(np.array([begin_s, stamp_s]), np.array([1.0, 2.0]))
    assert found.course.high.max() == 2.0
