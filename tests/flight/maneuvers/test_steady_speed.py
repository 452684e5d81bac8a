"""A manoeuvre ends where its air speed leaves the model."""

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.steady_speed import LEFT, at_steady_speed
from advisor.flight.signals.record import Channel

T = np.arange(9.0, 30.0, 0.1)
STEP = Span(9.0, 10.0, 24.0, 27.0, "pulse", ((10.0, -0.03), (24.0, 0.0)), "quiet")
QUICK = Span(9.0, 10.0, 14.0, 20.0, "doublet", ((10.0, -0.03), (12.0, 0.03), (14.0, 0.0)), "quiet")


def slowing(per_s, from_s=10.0):
    """An air speed of 90 m/s that falls by ``per_s`` of itself a second after ``from_s``."""
    return Channel("airspeed", T, 90.0 * (1.0 - per_s * np.clip(T - from_s, 0.0, None)))


def test_a_held_step_ends_where_the_speed_has_changed_by_its_limit():
    span = at_steady_speed(STEP, slowing(0.02), 15.0)
    assert span.end_s == pytest.approx(17.5, abs=0.15)
    assert span.last_step_s == 10.0
    assert span.steps == STEP.steps[:1]
    assert span.closed_by == LEFT


def test_a_free_response_ends_there_and_the_input_keeps_its_name():
    span = at_steady_speed(QUICK, slowing(0.03), 15.0)
    assert span.end_s == pytest.approx(15.0, abs=0.15)
    assert (span.kind, span.steps) == (QUICK.kind, QUICK.steps)


def test_a_speed_that_leaves_in_the_midst_of_the_input_cuts_nothing_off():
    assert at_steady_speed(QUICK, slowing(0.06), 15.0) is QUICK


def test_one_wild_reading_of_the_speed_cuts_nothing_off():
    steady = slowing(0.0)
    wild = steady.y.copy()
    wild[70] = 30.0
    assert at_steady_speed(STEP, Channel("airspeed", T, wild), 15.0) is STEP


@pytest.mark.parametrize("airspeed", [None, Channel("airspeed", T, np.zeros(len(T)))])
def test_without_an_air_speed_nothing_is_cut_off(airspeed):
    assert at_steady_speed(STEP, airspeed, 15.0) is STEP


def test_a_wider_limit_of_the_user_does_not_widen_what_the_model_follows():
    wide, followed = (at_steady_speed(STEP, slowing(0.02), limit) for limit in (60.0, 15.0))  # %
    assert wide == followed
