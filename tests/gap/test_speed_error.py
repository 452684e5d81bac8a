"""The air speed indicator is a noisy instrument: what it may be wrong by is no effect of the aircraft."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting.linear import linearise
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.airspeed import speed_error_factors
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX, SPEED
from tests.gap.generator import UAV, Setup, fly
from tests.maneuvers import without


def remembering(rng, n, memory):
    """Return noise of variance 1, each sample correlated with the one before."""
    found, e = np.empty(n), rng.standard_normal(n)
    found[0] = e[0]
    for k in range(1, n):
        found[k] = memory * found[k - 1] + np.sqrt(1.0 - memory**2) * e[k]
    return found


@pytest.mark.parametrize(("memory", "tolerance"), [(0.0, 0.1), (0.6, 0.3)])
def test_a_speed_is_doubted_by_what_noise_makes_of_a_parabola(memory, tolerance):
    rng, t = np.random.default_rng(1), np.arange(0.0, 6.0, 0.1)
    parabola = np.vander(2.0 * t / 6.0 - 1.0, 3, increasing=True)
    noise = np.array([0.3 * remembering(rng, len(t), memory) for _ in range(400)])
    fitted = noise @ np.linalg.pinv(parabola).T
    left = [e - parabola @ c for e, c in zip(noise, fitted, strict=True)]
    doubt = speed_error_factors([t] * len(left), left, [6.0] * len(left))[0]
    std = np.sqrt(np.diag(doubt @ doubt.T))
    assert std == pytest.approx(np.std(fitted, axis=0), rel=tolerance)


def test_a_few_samples_tell_nothing_of_the_instrument():
    t = np.arange(0.0, 1.0, 0.25)
    assert speed_error_factors([t], [np.ones(len(t))], [1.0])[0].shape == (0, 0)


def test_an_error_of_the_speed_is_flown_as_a_parabola_added_to_it():
    flights = prepare(fly(Setup(maneuvers=1, seed=3)), Aircraft())
    problem, flight = EffectProblem(flights, np.zeros(len(ENTRIES))), flights.flights[0]
    p = np.zeros(len(ENTRIES))
    p[: len(DERIVATIVES)] = -4.0, 0.0, -0.3, -35.0, -4.0, -45.0
    p[INDEX["Z_trim"]] = -0.44
    off = p.copy()
    names = ("speed_level_m_s", "speed_slope_m_s", "speed_bow_m_s")
    off[[INDEX[name] for name in names]] = 0.4, -0.3, 0.6
    along = 2.0 * np.arange(flight.n) / flight.n - 1.0
    slow = flight.slow.copy()
    slow[SPEED] += 0.4 - 0.3 * along + 0.6 * along**2
    there = problem.fly(replace(flight, slow=slow), p)
    np.testing.assert_allclose(problem.fly(flight, off), there, rtol=1e-9, atol=1e-12)
    assert np.max(np.abs(there - problem.fly(flight, p))) > 1e-4


def test_each_manoeuvre_has_three_numbers_for_it_where_it_was_measured_and_its_level_where_not():
    flown = fly(Setup(maneuvers=2, seed=3))
    blind = [without(m, "airspeed") for m in flown]
    point = SearchPoint(
        np.array([-4.0, 0.0, -0.3, -35.0, -4.0, -45.0]), np.tile([0.0, 0.0, -0.44, 0.0], (2, 1))
    )
    widths = []
    for some in (flown, blind):
        problem = EffectProblem(prepare(some, Aircraft(airspeed_m_s=UAV.speed)), np.zeros(len(ENTRIES)))
        widths.append(linearise(problem, point)[0].own.shape[1])
    assert widths[0] - widths[1] == 2


def test_readings_with_one_stamp_for_many_are_no_obstacle():
    t = np.repeat([0.5, 2.0], 6)
    left = np.random.default_rng(2).standard_normal(len(t))
    assert np.all(np.isfinite(speed_error_factors([t, t], [left, left], [6.0, 6.0])[0]))
