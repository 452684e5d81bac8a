"""Natural changes of a flight's telemetry, and how far an answer moves with each change."""

from pathlib import Path

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from benchmarks.metamorphic.__main__ import AS_FLOWN, Kept, Moved, answer_all, log_odds, table
from benchmarks.metamorphic.changes import CHANGES
from benchmarks.metamorphic.flights import Answer, flights_of, logs_of

BY_NAME = {change.name: change for change in CHANGES}
LOG = Path("logs/arduplane-calm.tlog")


def maneuver(number: int = 1) -> Maneuver:
    t = np.arange(0.0, 4.0, 0.02)
    span = Span(0.0, 1.0, 2.0, 4.0, "doublet", (), "quiet")
    names = ("elevator", "alpha", "q", "airspeed", "theta")
    return Maneuver(number, 0, span, {name: Channel(name, t, np.full(len(t), 20.0)) for name in names})


def moved(before: dict[str, float], after: dict[str, float], allowed: float = 1.0) -> Moved:
    return Moved("flight", CHANGES[0].name, Answer(before), Answer(after), allowed)


@pytest.mark.parametrize(
    ("change", "channel", "seconds"),
    [
        ("command stamps + 16 ms", "elevator", 0.016),
        ("command stamps - 16 ms", "elevator", -0.016),
        ("air speed 120 ms later", "airspeed", 0.12),
        ("alpha 20 ms later", "alpha", 0.02),
    ],
)
def test_a_late_stream_moves_the_stamps_of_its_channels_alone(change, channel, seconds):
    flown = maneuver()
    (late,) = BY_NAME[change].apply([flown])
    assert {name for name, c in late.channels.items() if not np.array_equal(c.t, flown.channels[name].t)} == {
        channel
    }
    assert late.channels[channel].t[0] == pytest.approx(seconds)
    assert np.array_equal(late.channels[channel].y, flown.channels[channel].y)


@pytest.mark.parametrize(
    ("change", "channel", "value"),
    [
        ("read air speed x .97", "airspeed", 19.4),
        ("read air speed x 1.03", "airspeed", 20.6),
        ("gyro bias + .1 deg/s", "q", 20.0 + np.radians(0.1)),
        ("gyro bias - .1 deg/s", "q", 20.0 - np.radians(0.1)),
    ],
)
def test_a_wrong_reading_changes_the_values_of_its_channel_alone(change, channel, value):
    (read,) = BY_NAME[change].apply([maneuver()])
    assert {name for name, c in read.channels.items() if not np.all(c.y == 20.0)} == {channel}
    assert np.allclose(read.channels[channel].y, value)


def test_the_last_manoeuvre_is_removed_from_a_flight_that_keeps_enough() -> None:
    change = BY_NAME["one manoeuvre less"]
    flown = [maneuver(number) for number in range(1, 5)]
    assert change.changes(flown)
    assert [m.number for m in change.apply(flown)] == [1, 2, 3]
    assert not change.changes(flown[:3])


def test_a_change_of_a_channel_that_no_manoeuvre_has_is_left_out() -> None:
    without = maneuver()
    channels = {name: c for name, c in without.channels.items() if name != "alpha"}
    without = Maneuver(1, 0, without.span, channels)
    assert not BY_NAME["alpha 20 ms later"].changes([without])


def test_a_prior_of_ten_milliseconds_allows_four_and_a_half_nats_for_sixteen() -> None:
    # From 20 ms to 36 ms late: ½·(3.6² − 2²) = 4.48.
    assert BY_NAME["command stamps + 16 ms"].allowed_nats == pytest.approx(4.48)
    assert BY_NAME["one manoeuvre less"].allowed_nats == np.inf


def test_an_answer_stays_where_the_likeliest_name_does() -> None:
    assert moved({"none": 0.9, "unknown": 0.1}, {"none": 0.6, "unknown": 0.4}).stays
    assert not moved({"none": 0.9, "unknown": 0.1}, {"none": 0.4, "unknown": 0.6}).stays


def test_the_move_of_a_probability_is_measured_in_log_odds() -> None:
    pair = moved({"none": 0.9, "unknown": 0.1}, {"none": 0.5, "unknown": 0.5})
    assert pair.moved_nats == pytest.approx(np.log(9.0))
    assert not pair.is_allowed
    assert log_odds(1.0) == pytest.approx(np.log(999.0))


def test_the_table_counts_the_answers_that_stay_by_change_and_over_all_changes() -> None:
    pairs = [moved({"none": 0.9}, {"none": 0.9}), moved({"none": 0.9}, {"unknown": 0.9})]
    _, first, last = table(pairs)
    assert first.split()[:7] == ["command", "stamps", "+", "16", "ms", "1", "of"]
    assert last.split()[:4] == ["all", "1", "of", "2"]


def test_answers_that_are_kept_are_read_again(tmp_path: Path) -> None:
    kept = Kept(tmp_path / "answers.jsonl")
    kept.add("flight", AS_FLOWN, Answer({"none": 0.8, "unknown": 0.2}))
    kept.add("flight", CHANGES[0].name, Answer({"none": 0.7, "unknown": 0.3}))
    (pair,) = Kept(tmp_path / "answers.jsonl").pairs()
    assert (pair.before.of("none"), pair.after.of("none")) == (0.8, 0.7)


def test_logs_without_an_aircraft_file_are_not_diagnosed() -> None:
    assert [log.name for log in logs_of([Path("logs")])] == ["arduplane-calm.tlog"]


@pytest.mark.study
@pytest.mark.parametrize("change", ["command stamps + 16 ms", "read air speed x .97", "gyro bias + .1 deg/s"])
def test_the_answer_to_the_recorded_flight_stays(change: str, tmp_path: Path) -> None:
    kept = Kept(tmp_path / "answers.jsonl")
    answer_all(LOG, ["pitch"], [BY_NAME[change]], kept)
    (pair,) = kept.pairs()
    assert pair.stays
    assert pair.is_allowed


def test_a_flight_is_read_for_each_axis_that_it_tested() -> None:
    assert [axis for axis, _ in flights_of(LOG, ["pitch"])] == ["pitch"]
