"""A solution carried on over new samples is the one that all samples give."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.carried import UpdatableSolution
from advisor.oem.colour import Colour
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import report
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.solution import Solution, solve
from advisor.oem.weighted_sums import Sums
from tests.oem.builders import JET, flown

AIRCRAFT = Aircraft(elevator=Elevator(lag_s=0.1))
FLIGHT = flown(JET, noise=0.03)


def so_far(until_s: float, maneuver: Maneuver = FLIGHT) -> Maneuver:
    channels = {name: channel.cut(-1.0, until_s) for name, channel in maneuver.channels.items()}
    return replace(maneuver, channels=channels)


def solved(maneuver: Maneuver) -> tuple[Solution, Prepared, Estimate]:
    prepared = prepare([maneuver], AIRCRAFT)
    assert isinstance(prepared, Prepared)
    solution = solve(prepared.problem)
    assert isinstance(solution, Solution)
    return solution, prepared, report(solution, prepared, AIRCRAFT, quick=True)


def test_an_estimate_carried_on_sample_by_sample_is_that_of_all_samples() -> None:
    carried = UpdatableSolution(*solved(so_far(11.0)))
    found = None
    for until_s in np.arange(11.02, 11.5, 0.02):
        found = carried.on(so_far(until_s))
    *_, whole = solved(so_far(until_s))
    assert found is not None
    assert {name: len(fit.t) for name, fit in found.fits[0].items()} == {
        name: len(fit.t) for name, fit in whole.fits[0].items()
    }
    np.testing.assert_array_less(np.abs(found.theta - whole.theta), 0.02 * whole.std_cr)
    np.testing.assert_allclose(found.std_cr, whole.std_cr, rtol=0.01)
    np.testing.assert_allclose(found.cost, whole.cost, rtol=0.01)


def test_a_solution_is_carried_on_alike_in_one_step_and_in_many() -> None:
    many, one = UpdatableSolution(*solved(so_far(11.0))), UpdatableSolution(*solved(so_far(11.0)))
    for until_s in np.arange(11.02, 11.45, 0.02):
        many.on(so_far(until_s))
    stepped, at_once = many.on(so_far(11.46)), one.on(so_far(11.46))
    assert stepped is not None
    assert at_once is not None
    np.testing.assert_allclose(stepped.theta, at_once.theta, rtol=1e-6)
    np.testing.assert_allclose(stepped.covariance, at_once.covariance, rtol=1e-6)


def test_without_new_samples_the_estimate_stays() -> None:
    solution, prepared, reported = solved(so_far(11.0))
    found = UpdatableSolution(solution, prepared, reported).on(so_far(11.0))
    assert found is not None
    np.testing.assert_array_less(np.abs(found.theta - reported.theta), 1e-3 * reported.std_cr)
    np.testing.assert_allclose(found.covariance_cr, reported.covariance_cr, rtol=1e-3)
    np.testing.assert_allclose(found.covariance, reported.covariance, rtol=1e-3)


def test_a_sample_that_arrives_late_asks_for_a_complete_solution() -> None:
    alpha = FLIGHT.channels["alpha"]
    early = {**so_far(11.0).channels, "alpha": alpha.cut(-1.0, 10.5)}
    carried = UpdatableSolution(*solved(replace(FLIGHT, channels=early)))
    assert carried.on(so_far(11.1)) is None


def test_samples_that_contradict_the_solution_ask_for_a_complete_one() -> None:
    carried = UpdatableSolution(*solved(so_far(11.0)))
    q = FLIGHT.channels["q"]
    wrong = replace(q, y=np.where(q.t > 11.0, q.y + 0.5, q.y))
    assert carried.on(so_far(11.4, replace(FLIGHT, channels={**FLIGHT.channels, "q": wrong}))) is None


def test_sums_give_what_the_autocovariance_of_the_noise_gives() -> None:
    rng = np.random.default_rng(2)
    g, residual = rng.standard_normal((40, 3)), rng.standard_normal(40)
    colour = Colour(2.0, 0.9, 0.3, np.zeros((3, 3)))
    sums = Sums.none(3, colour)
    sums.add(g[:25], residual[:25])
    sums.add(g[25:], residual[25:])
    lag = np.abs(np.subtract.outer(np.arange(40), np.arange(40)))
    autocovariance = colour.memory**lag + colour.white_share * np.eye(40)
    np.testing.assert_allclose(sums.coloured, g.T @ autocovariance @ g)
    np.testing.assert_allclose(sums.gram[:3, :3], g.T @ g)
    step = rng.standard_normal(3)
    np.testing.assert_allclose(sums.power(step), np.mean((residual - g @ step) ** 2))
