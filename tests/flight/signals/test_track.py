"""A track keeps what it is asked to keep, whatever its buffer holds at the start."""

import numpy as np
import pytest

from advisor.flight.signals.track import ChannelStatus, Track


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
