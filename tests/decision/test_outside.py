"""A record that is incomplete or outside the model, each limit on both sides of its number."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.envelope import (
    changed_speed,
    follows_motion,
    incomplete,
    is_broken_off,
    other_controls,
    saturated,
    short_response,
    steep,
    throttled,
    too_quick,
    too_slow,
    with_gap,
)
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel

T = np.arange(0.0, 20.0, 0.02)
STEPS = ((4.0, 0.1), (6.0, -0.1), (8.0, 0.0))
DEG = np.pi / 180.0


def swing(deg: float) -> np.ndarray:
    """A movement over a range of this size, about zero, rad."""
    return 0.5 * deg * DEG * np.sin(2.0 * T)


def record(
    t: np.ndarray = T, closed_by: str = "quiet", steps=STEPS, end_s: float = 19.0, **moved
) -> Maneuver:
    span = Span(0.0, 4.0, 8.0, end_s, "3-2-1-1", steps, closed_by)
    return Maneuver(
        1, 0, span, {name: Channel(name, t, np.asarray(y), "X.y") for name, y in moved.items()}, "MANUAL"
    )


def told(reasons) -> list[str]:
    return [reason.code for reason in reasons]


def without(begin_s: float, seconds: float) -> np.ndarray:
    """Times of a channel of 50 Hz with a gap of this length."""
    before = T[begin_s >= T]
    return np.concatenate([before, T[before[-1] + seconds <= T + 1e-9]])


@pytest.mark.parametrize(("hz", "codes"), [(7.9, ["rate"]), (8.1, [])])
def test_a_natural_period_has_eight_samples(hz: float, codes: list[str]) -> None:
    t = np.arange(0.0, 20.0, 1.0 / hz)
    assert told(too_slow([Channel("q", t, 0.0 * t, "X.y")], 1.0)) == codes


@pytest.mark.parametrize(
    ("period_s", "gap_s", "codes"),
    [
        (2.0, 0.58, []),
        (2.0, 0.64, ["gap"]),
        (0.1, 0.18, []),
        (0.1, 0.24, ["gap"]),
        (9.0, 0.96, []),
        (9.0, 1.06, ["gap"]),
    ],
)
def test_a_gap_lasts_three_tenths_of_a_period_at_least_a_fifth_of_a_second_and_at_most_one(
    period_s: float, gap_s: float, codes: list[str]
) -> None:
    t = without(10.0, gap_s)
    assert told(with_gap([Channel("q", t, 0.0 * t, "X.y")], record(), period_s)) == codes


@pytest.mark.parametrize(("intervals", "codes"), [(3, []), (4, ["gap"])])
def test_three_intervals_of_a_slow_channel_are_no_gap(intervals: int, codes: list[str]) -> None:
    t = np.arange(0.0, 20.0, 0.25)
    t = np.concatenate([t[t <= 10.0], t[t >= 10.0 + 0.25 * intervals]])
    assert told(with_gap([Channel("q", t, 0.0 * t, "X.y")], record(), 0.1)) == codes


def test_only_the_longest_gap_of_all_channels_is_told() -> None:
    channels = [
        Channel(name, (t := without(10.0, gap_s)), 0.0 * t, "X.y")
        for name, gap_s in (("q", 2.0), ("alpha", 3.0))
    ]
    (reason,) = with_gap(channels, record(), 1.0)
    assert reason.text.startswith("3.0 s of alpha")


def test_a_needed_channel_that_is_missing_is_the_one_reason() -> None:
    assert told(incomplete(record(q=swing(4.0)), ("q", "alpha"), 1.0, ())) == ["missing"]
    assert told(incomplete(record(q=swing(4.0)), ("q",), 1.0, ("alpha",))) == []


@pytest.mark.parametrize(
    ("closed_by", "last", "broken_off"),
    [("gap", 0.1, True), ("gap", 0.0, False), ("quiet", 0.1, False), ("end of log", 0.1, True)],
)
def test_a_record_is_broken_off_where_something_ends_it_away_from_trim(closed_by, last, broken_off):
    span = record(closed_by=closed_by, steps=(*STEPS[:-1], (8.0, last))).span
    assert is_broken_off(span) is broken_off
    assert not is_broken_off(replace(span, steps=()))


@pytest.mark.parametrize(("free_s", "codes"), [(1.4, ["free_response"]), (1.6, [])])
def test_the_free_response_lasts_three_quarters_of_a_period(free_s: float, codes: list[str]) -> None:
    assert told(short_response(record(end_s=8.0 + free_s), 2.0)) == codes


def speeding(percent: float, samples: int = 900) -> np.ndarray:
    """An air speed that changes after the first step, for this many samples."""
    speed = np.full(len(T), 20.0)
    speed[300 : 300 + samples] *= 1.0 + 0.01 * percent
    return speed


def test_the_air_speed_keeps_its_value_but_for_one_wild_reading() -> None:
    limit = Aircraft().limits.airspeed_change_percent
    assert told(changed_speed(record(airspeed=speeding(1.1 * limit)), Aircraft())) == ["airspeed"]
    assert told(changed_speed(record(airspeed=speeding(0.9 * limit)), Aircraft())) == []
    assert told(changed_speed(record(airspeed=speeding(80.0, 1)), Aircraft())) == []
    assert told(changed_speed(record(airspeed=speeding(80.0, 2)), Aircraft())) == ["airspeed"]


@pytest.mark.parametrize(
    "speed", [np.zeros(len(T)), np.zeros(0), np.full(1, 20.0)], ids=["still", "empty", "one"]
)
def test_an_air_speed_that_tells_nothing_has_not_changed(speed: np.ndarray) -> None:
    given = record()
    given.channels["airspeed"] = Channel("airspeed", 5.0 + T[: len(speed)], speed, "X.y")
    assert told(changed_speed(given, Aircraft())) == []
    assert told(changed_speed(record(), Aircraft())) == []


def stuck(samples: int, deg: float = 25.0) -> np.ndarray:
    deflection = np.zeros(len(T))
    deflection[400 : 400 + samples] = deg * DEG
    return deflection


@pytest.mark.parametrize(("samples", "codes"), [(1, []), (2, ["saturation"])])
@pytest.mark.parametrize("deg", [25.0, -25.0])
def test_a_control_is_stuck_where_two_samples_lie_at_its_end(samples, deg, codes):
    assert told(saturated(record(elevator=stuck(samples, deg)), "elevator", None)) == codes
    assert told(saturated(record(elevator=stuck(samples, 0.8 * deg)), "elevator", None)) == []
    assert told(saturated(record(elevator=stuck(samples, 0.8 * deg)), "elevator", (20.0, -20.0))) == codes
    assert told(saturated(record(), "elevator", None)) == []


@pytest.mark.parametrize(("share", "codes"), [(0.19, ["follows"]), (0.21, [])])
def test_an_elevator_that_moves_less_than_a_fifth_of_another_control_follows_the_motion(share, codes):
    both = record(elevator=swing(10.0 * share), aileron=swing(10.0), rudder=swing(2.0))
    reasons = follows_motion(both, "elevator", ("rudder", "aileron"))
    assert told(reasons) == codes
    assert all("next to the aileron" in reason.text for reason in reasons)


def test_what_was_not_recorded_has_not_moved() -> None:
    nothing = record()
    assert told(other_controls(nothing, ("aileron",), "")) == told(throttled(nothing)) == []
    assert told(steep(nothing, 5.0)) == []


@pytest.mark.parametrize(("deg", "codes"), [(11.9, []), (12.1, ["alpha"])])
def test_an_angle_of_attack_has_the_limit_that_the_crew_gives(deg: float, codes: list[str]) -> None:
    assert told(steep(record(alpha=swing(2.0 * deg)), 12.0)) == codes
    assert told(steep(record(alpha=swing(2.0 * deg)), None)) == []


def stepped(*onsets_s, kind="3-2-1-1"):
    return SimpleNamespace(span=SimpleNamespace(kind=kind, steps=[(onset, 0.1) for onset in onsets_s]))


@pytest.mark.parametrize(("step_s", "is_too_short"), [(0.1, True), (0.2, False)])
def test_a_step_shorter_than_a_seventh_of_the_period_is_too_short(step_s, is_too_short):
    found = too_quick(stepped(10.0, 11.0, 11.0 + step_s), 1.0)
    assert [reason.code for reason in found] == (["steps"] if is_too_short else [])


def test_a_multisine_and_a_single_step_have_no_shortest_step():
    assert too_quick(stepped(10.0, 10.01, kind="multisine"), 1.0) == []
    assert too_quick(stepped(10.0), 1.0) == []
