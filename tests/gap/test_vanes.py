"""A vane whose bearing rubs, or that meets a stop, is unknown in the angle of attack."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import INDEX
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HARD = Setup(gust_std=0.12, coloured=0.5, jitter=0.004, speed_change=0.03, seed=37)


def rubbed(angles, half_play):
    """Return the angles of a pointer that follows once the vane has run ahead by half the play."""
    shown = [angles[0]]
    for angle in angles[1:]:
        ahead = angle - shown[-1]
        shown.append(shown[-1] + np.sign(ahead) * max(abs(ahead) - half_play, 0.0))
    return np.array(shown)


def through_the_vane(setup, reading):
    """Return the flight with another vane, and its noise behind it."""
    rng, flown = np.random.default_rng(5), []
    for maneuver in fly(replace(setup, noise=0.1 * setup.noise)):
        alpha = maneuver.channels["alpha"]
        noise = setup.noise * np.ptp(alpha.y) / 2.0 * rng.standard_normal(len(alpha))
        channels = {**maneuver.channels, "alpha": replace(alpha, y=reading(alpha.y) + noise)}
        flown.append(replace(maneuver, channels=channels))
    return flown


@pytest.fixture(scope="module")
def flown():
    """Return a manoeuvre ready to be simulated, its driving numbers, and the angle that a good vane shows."""
    problem, fitted = fit_baseline(prepare(fly(Setup(maneuvers=2, seed=4)), Aircraft()), Aircraft())
    p, flight = problem.driving(fitted.point)[0], problem.flights.flights[0]
    return problem, flight, p, problem.fly(flight, p)[0]


def shown_with(flown, **entries):
    """Return the simulated angle of attack with some numbers of the vane."""
    problem, flight, p, _ = flown
    changed = p.copy()
    for name, value in entries.items():
        changed[INDEX[name]] = value
    return problem.fly(flight, changed)[0]


def test_a_vane_that_rubs_follows_behind_its_play_and_one_with_stops_turns_as_far_as_to_them(flown):
    _, flight, _, good = flown
    assert shown_with(flown, vane_play_rad=0.004) == pytest.approx(rubbed(good, 0.004), abs=1e-12)
    trim = flight.alpha_trim
    stopped = shown_with(flown, vane_stop_up_rad=0.02, vane_stop_down_rad=0.01)
    assert stopped == pytest.approx(np.clip(good, trim - 0.01, trim + 0.02), abs=1e-12)


@pytest.mark.parametrize("setup", [Setup(maneuvers=6, seed=3), pytest.param(HARD, marks=pytest.mark.study)])
def test_a_vane_that_rubs_is_no_vane_at_another_place_and_none_that_lags(setup):
    found = diagnose(through_the_vane(setup, lambda y: rubbed(y, 0.006)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "alpha_sensor")
    assert any("bearing rubs: the air turns by 0.3 deg before it follows" in note for note in found.notes)


@pytest.mark.parametrize("setup", [HARD, pytest.param(Setup(seed=3), marks=pytest.mark.study)])
def test_a_vane_that_meets_a_stop_is_no_moving_air_and_no_lift_that_bends(setup):
    found = diagnose(through_the_vane(setup, lambda y: np.minimum(y, 0.09)), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "alpha_sensor")
    assert any("it meets a stop" in note for note in found.notes)
