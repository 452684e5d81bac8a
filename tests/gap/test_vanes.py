"""A vane whose bearing rubs, or that meets a stop, is unknown in the angle of attack."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import INDEX
from tests.gap.generator import Setup, fly
from tests.gap.studied_flights import rubbed


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


def test_where_the_flow_lets_go_is_met_within_a_step_and_not_at_its_end():
    """Else no search would find the angle: the motion would change with it by jumps."""
    problem, fitted = fit_baseline(prepare(fly(Setup(maneuvers=2, seed=46)), Aircraft()), Aircraft())
    p, flight = problem.driving(fitted.point)[0], problem.flights.flights[0]
    p[INDEX["Z_separated"]], motions = 0.05, []
    for at in 0.02 + 2e-5 * np.arange(40):
        p[[INDEX["separation_rad"], INDEX["attachment_rad"]]] = at, -0.01
        motions.append(problem.fly(flight, p)[1])
    changes = np.linalg.norm(np.diff(motions, axis=0), axis=1)
    assert np.max(changes) < 3.0 * np.median(changes)
