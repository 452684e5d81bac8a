"""Probability of an own input: hands that hold the attitude have one near 0, tests have one near 1."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.purpose import judged
from advisor.flight.maneuvers.stepped_input import odds_of_own_input
from advisor.flight.signals.record import Channel
from tests.flight.elevator.elevators import coloured
from tests.rows import row

DEG = np.radians(1.0)
STEP_S = 0.02
T = np.arange(0.0, 60.0, STEP_S)
TEST_S, RECOVERY_S = 40.0, 46.0
HAND_S = 0.15
ONSETS, LEVELS = (0.0, 0.9, 1.5, 1.8, 2.1), (1.0, -1.0, 1.0, -1.0, 0.0)
"""Steps of a 3-2-1-1, s after its begin, and their levels."""


def slewed(since_s, edge_s):
    """Level of a doublet of 2 s whose edges last a time."""
    times = [0.0, edge_s, 1.0, 1.0 + edge_s, 2.0, 2.0 + edge_s]
    return float(np.interp(since_s, times, [0.0, 1.0, 1.0, -1.0, -1.0, 0.0]))


def flight(control=-20.0, tremor=0.1, test_s=TEST_S, size=4.0, late=HAND_S, edge_s=0.0):
    """Channels of hands that hold the attitude, of a test with still hands, and of hands that recover.

    The test is a 3-2-1-1, or with an ``edge_s`` a doublet.
    """
    rng = np.random.default_rng(5)
    shaken = tremor * DEG * coloured(rng, T, 0.3)
    elevator, q, theta, alpha = (np.zeros(len(T)) for _ in range(4))
    side = -np.sign(control)
    behind = round(late / STEP_S)
    for i in range(1, len(T)):
        since_s = T[i - 1] - test_s
        if 0.0 <= since_s < RECOVERY_S - TEST_S:
            level = LEVELS[int(np.searchsorted(ONSETS, since_s, side="right")) - 1]
            level = slewed(since_s, edge_s) if edge_s else level
            elevator[i - 1] = size * DEG * level + 0.1 * shaken[i - 1]
        else:
            seen = max(i - 1 - behind, 0)
            elevator[i - 1] = side * (0.4 * theta[seen] + 0.05 * q[seen]) + shaken[i - 1]
        alpha[i] = alpha[i - 1] + STEP_S * (-3.0 * alpha[i - 1] + q[i - 1])
        q[i] = q[i - 1] + STEP_S * (-20.0 * alpha[i - 1] - 4.0 * q[i - 1] + control * elevator[i - 1])
        theta[i] = theta[i - 1] + STEP_S * q[i - 1]
    values = {"elevator": elevator, "q": q, "theta": theta}
    return {name: Channel(name, T, y) for name, y in values.items()}


def span(start_s, last_step_s, level=4.0 * DEG):
    steps = ((start_s, level), (last_step_s, 0.0))
    return Span(start_s - 1.0, start_s, last_step_s, last_step_s + 3.0, "other", steps, "quiet")


TEST, RECOVERY = span(TEST_S, TEST_S + 2.1), span(RECOVERY_S, RECOVERY_S + 2.0)
HELD = span(20.0, 24.0)


def odds(which, channels, effect=-1.0, tests=()):
    motion = {name: channel.cut(which.start_s - 30.0, which.end_s) for name, channel in channels.items()}
    found = odds_of_own_input(which, motion["elevator"], motion["q"], motion["theta"], effect, tests)
    assert found is not None
    return found


def probability(which, channels, effect=-1.0, tests=()):
    return odds(which, channels, effect, tests).probability


def told(which, channels, tests=()):
    record = {name: channel.cut(which.record_from_s, which.end_s) for name, channel in channels.items()}
    motion = {name: channel.cut(which.start_s - 30.0, which.end_s) for name, channel in channels.items()}
    spans = [replace(TEST, start_s=start_s, end_s=end_s) for start_s, end_s in tests]
    return judged(Maneuver(1, 0, which, record, "MANUAL"), None, motion, tests=spans)


def reason(which, channels, tests=()):
    found = told(which, channels, tests)
    return None if isinstance(found, Span) else found.reason


def test_a_test_from_steady_flight_is_an_own_input():
    assert probability(TEST, flight()) > 0.999


AFTER = [(TEST_S, RECOVERY_S)]


@row("a recovery after the test is none", RECOVERY, {}, AFTER, 0.05)
@row("a recovery without any delay is none", RECOVERY, {"late": 0.0}, AFTER, 0.05)
@row("hands that tremble count for nothing", HELD, {"tremor": 0.5}, (), 0.95)
@row("a test no larger than the hands before is in doubt", TEST, {"tremor": 4.0, "size": 0.5}, (), 0.95)
def test_the_probability_of_an_own_input_is_below(which, changes, tests, limit):
    assert probability(which, flight(**changes), tests=tests) < limit


@pytest.mark.parametrize("after_s", [0.0, 0.03, 0.05, 0.08, 0.1])
def test_hands_may_take_over_between_two_bins(after_s):
    begun = replace(RECOVERY, start_s=RECOVERY_S - after_s)
    assert probability(begun, flight(), tests=[(TEST_S, RECOVERY_S - after_s)]) < 0.05


@pytest.mark.parametrize("control", [-20.0, 20.0])
def test_the_side_that_steadies_follows_from_the_effect_of_the_control(control):
    channels, tests = flight(control), [(TEST_S, RECOVERY_S)]
    steadies, upsets = (odds(RECOVERY, channels, side * np.sign(control), tests) for side in (1.0, -1.0))
    assert steadies.log_odds < upsets.log_odds


def test_the_slow_edges_of_a_hand_leave_more_than_half_of_the_odds_of_sharp_ones():
    slow, sharp = (odds(TEST, flight(size=3.0, tremor=0.3, edge_s=edge_s)).log_odds for edge_s in (0.4, 0.2))
    assert slow > 0.5 * sharp


def test_the_integral_of_the_rate_stands_for_a_missing_angle():
    channels = flight()
    motion = {name: channel.cut(TEST_S - 30.0, TEST.end_s) for name, channel in channels.items()}
    found = odds_of_own_input(TEST, motion["elevator"], motion["q"], None, -1.0)
    assert found is not None
    assert found.probability > 0.999


def test_without_seconds_before_the_movement_there_are_no_odds():
    channels = {name: channel.cut(TEST_S - 1.0, TEST.end_s) for name, channel in flight().items()}
    assert odds_of_own_input(TEST, channels["elevator"], channels["q"], channels["theta"], -1.0) is None


def test_a_recovery_is_listed_with_its_probability_and_the_test_before_counts():
    channels = flight()
    assert told(TEST, channels) == TEST
    found = told(RECOVERY, channels, [(TEST_S, RECOVERY_S)])
    assert found.reason == "feedback"
    assert "% (at least 95)" in found.text


def test_a_control_sampled_at_the_hands_delay_is_judged_by_its_shape():
    slow = {name: Channel(name, channel.t[::5], channel.y[::5]) for name, channel in flight().items()}
    assert told(RECOVERY, slow, [(TEST_S, RECOVERY_S)]) == RECOVERY


def test_a_test_after_hands_in_one_movement_is_cut_where_it_begins():
    swallowed = span(TEST_S - 6.0, TEST_S + 2.1)
    found = told(swallowed, flight(tremor=0.3))
    assert isinstance(found, Span)
    assert found.start_s == pytest.approx(TEST_S, abs=0.15)
    assert found.last_step_s == pytest.approx(TEST_S + 2.1, abs=0.15)
    assert found.kind == "reverse 3-2-1-1" or found.kind == "3-2-1-1"
    assert found.end_s == swallowed.end_s


def unstable_flight():
    """Channels of a statically unstable aircraft, steadied from α and q, with a doublet of 2 deg."""
    shaken = 0.02 * DEG * coloured(np.random.default_rng(6), T, 1.0)
    elevator, q, theta, alpha = (np.zeros(len(T)) for _ in range(4))
    for i in range(1, len(T)):
        since_s = T[i - 1] - TEST_S
        moved = 2.0 * DEG * ((0.0 <= since_s < 0.5) - 1.0 * (0.5 <= since_s < 1.0))
        elevator[i - 1] = moved + 1.2 * (alpha[i - 1] + shaken[i - 1]) + 0.4 * q[i - 1]
        alpha[i] = alpha[i - 1] + STEP_S * (-1.4 * alpha[i - 1] + q[i - 1])
        q[i] = q[i - 1] + STEP_S * (9.6 * alpha[i - 1] - 3.7 * q[i - 1] - 12.8 * elevator[i - 1])
        theta[i] = theta[i - 1] + STEP_S * q[i - 1]
    values = {"elevator": elevator, "q": q, "theta": theta}
    return {name: Channel(name, T, y) for name, y in values.items()}


def test_an_input_to_an_unstable_aircraft_counts_though_feedback_explains_most_of_it():
    channels, doublet = unstable_flight(), span(TEST_S, TEST_S + 1.0, 2.0 * DEG)
    assert told(doublet, channels) == doublet


@pytest.mark.parametrize(("until_s", "is_test"), [(TEST_S, False), (T[-1], True)])
def test_an_input_that_ends_a_rotation_is_none_and_one_in_a_turn_is(until_s, is_test):
    rolling = flight()
    turned = np.where((TEST_S - 1.0 < T) & (until_s > T), 0.5, 0.0)
    channels = {**rolling, "q": Channel("q", T, rolling["q"].y + turned)}
    found = told(TEST, channels)
    assert isinstance(found, Span) == is_test
    if not is_test:
        assert found.reason == "feedback"
        assert "begins from rest" in found.text


def test_hands_that_fly_at_another_level_are_cut_off_too():
    channels = flight(tremor=0.3)
    elevator = channels["elevator"]
    drawn = np.clip((T - TEST_S + 6.0) / 3.0, 0.0, 1.0) * (TEST_S > T)
    trimmed = 3.0 * DEG * drawn * (1.0 + 0.3 * np.sin(2.0 * T))
    moved = {**channels, "elevator": Channel("elevator", T, elevator.y + trimmed)}
    found = told(span(TEST_S - 6.0, TEST_S + 2.1), moved)
    assert isinstance(found, Span)
    assert found.start_s == pytest.approx(TEST_S, abs=0.15)


@pytest.mark.parametrize(("kind", "reason"), [("other", "small"), ("pulse", "small"), ("3-2-1-1", None)])
def test_an_input_much_smaller_than_the_tests_before_is_a_correction(kind, reason):
    channels = flight()
    steps = tuple((onset, 0.2 * level) for onset, level in TEST.steps)
    record = {name: channel.cut(TEST.record_from_s, TEST.end_s) for name, channel in channels.items()}
    before = replace(TEST, start_s=10.0, end_s=14.0)
    small = Maneuver(1, 0, replace(TEST, steps=steps, kind=kind), record, "MANUAL")
    found = judged(small, None, channels, tests=[before])
    if reason is None:
        assert isinstance(found, Span)
    else:
        assert found.reason == reason
        assert "20 % of the tests before (at least 25)" in found.text
