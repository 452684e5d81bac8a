"""Feedback of the motion by hand: a recovery of the attitude is an answer, a test input is none."""

import numpy as np
import pytest

from advisor.flight.maneuvers.feedback import explained_by_feedback
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.purpose import not_an_input
from advisor.flight.signals.record import Channel
from tests.flight.elevator.elevators import coloured

DEG = np.radians(1.0)
STEP_S = 0.02
T = np.arange(0.0, 20.0, STEP_S)
TEST_S, RECOVERY_S = 6.0, 10.0
HAND_S = 0.15


def flight(control=-20.0, tremor=0.05):
    """Channels of a pulse by a still hand, then of a hand that brings the attitude back by its feedback."""
    rng = np.random.default_rng(5)
    shaken = tremor * DEG * coloured(rng, T, 1.0)
    elevator, q, theta, alpha = (np.zeros(len(T)) for _ in range(4))
    side = -np.sign(control)
    for i in range(1, len(T)):
        late = i - 1 - round(HAND_S / STEP_S)
        if TEST_S <= T[i - 1] < TEST_S + 0.8:
            elevator[i - 1] = 4.0 * DEG
        elif T[i - 1] >= RECOVERY_S:
            elevator[i - 1] = side * (0.4 * theta[late] + 0.05 * q[late])
        elevator[i - 1] += shaken[i - 1]
        alpha[i] = alpha[i - 1] + STEP_S * (-3.0 * alpha[i - 1] + q[i - 1])
        q[i] = q[i - 1] + STEP_S * (-20.0 * alpha[i - 1] - 4.0 * q[i - 1] + control * elevator[i - 1])
        theta[i] = theta[i - 1] + STEP_S * q[i - 1]
    values = {"elevator": elevator, "q": q, "theta": theta}
    return {name: Channel(name, T, y) for name, y in values.items()}


def span(start_s, last_step_s, level):
    steps = ((start_s, level), (last_step_s, 0.0))
    return Span(start_s - 1.0, start_s, last_step_s, last_step_s + 3.0, "pulse", steps, "quiet")


PULSE = span(TEST_S, TEST_S + 0.8, 4.0 * DEG)
RECOVERY = span(RECOVERY_S, RECOVERY_S + 1.5, -1.0 * DEG)


def share(which, channels, effect=-1.0):
    motion = {name: channels[name].cut(which.start_s - 15.0, which.end_s) for name in ("q", "theta")}
    return explained_by_feedback(which, channels["elevator"], motion, effect)


def test_feedback_explains_a_recovery_of_the_attitude():
    assert share(RECOVERY, flight()) > 0.6


def test_feedback_explains_no_input_from_steady_flight():
    assert share(PULSE, flight()) == 0.0


@pytest.mark.parametrize("control", [-20.0, 20.0])
def test_the_side_that_steadies_follows_from_the_effect_of_the_control(control):
    channels = flight(control)
    assert share(RECOVERY, channels, np.sign(control)) > 0.6
    assert share(RECOVERY, channels, -np.sign(control)) < 0.5


def test_without_a_pitch_angle_nothing_counts_as_feedback():
    channels = flight()
    assert explained_by_feedback(RECOVERY, channels["elevator"], {"q": channels["q"]}, -1.0) == 0.0


@pytest.mark.parametrize(("which", "reason"), [(PULSE, None), (RECOVERY, "feedback")])
def test_a_recovery_is_an_activity_and_the_input_before_it_is_a_test(which, reason):
    channels = flight()
    record = {name: channel.cut(which.record_from_s, which.end_s) for name, channel in channels.items()}
    because = not_an_input(Maneuver(1, 0, which, record, "MANUAL"), None, channels)
    assert (because and because.reason) == reason


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
    record = {name: channel.cut(doublet.record_from_s, doublet.end_s) for name, channel in channels.items()}
    assert share(doublet, channels) > 0.5
    assert not_an_input(Maneuver(1, 0, doublet, record, "MANUAL"), None, channels) is None


def test_hands_that_move_no_faster_than_before_fly_no_test():
    channels = flight(tremor=1.0)
    calm = span(14.0, 16.0, 0.3 * DEG)
    record = {name: channel.cut(13.0, 19.0) for name, channel in channels.items()}
    because = not_an_input(Maneuver(1, 0, calm, record, "MANUAL"))
    assert because is not None
    assert because.reason == "small"
    assert "no faster than" in because.text
