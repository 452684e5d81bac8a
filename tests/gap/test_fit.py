"""The fit flies no more than it must: a step is worth a flight only for what it promises."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import variants_for
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.linear import linearise
from advisor.gap.fitting.neighbourhood import Neighbourhood
from advisor.gap.fitting.prior import ERROR_IF_WRONG, prior_precision
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, row_weights
from advisor.gap.fitting.step import own_eliminated
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Cause, Value
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import ENTRIES, INDEX, OUTPUTS
from advisor.gap.verdict.causes import with_model_errors
from advisor.oem.arrow import solved_within
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def settled():
    flights = prepare(fly(Setup(maneuvers=3, seed=41)), Aircraft())
    return fit_baseline(flights, Aircraft())


def test_a_fit_begun_at_its_optimum_is_flown_once_and_stays_there(settled):
    problem, fitted = settled
    # The cost is rough, so that a search may end next to a step that promises a little more than a tenth.
    again = fit(problem, fitted.point, fitted.noise, tolerance=0.2)
    assert again.iterations == 1
    assert again.cost == pytest.approx(fitted.cost, abs=0.1)


def test_a_fit_begun_nearby_comes_back(settled):
    problem, fitted = settled
    shifted = fitted.point.derivatives * np.array([1.05, 1.0, 1.0, 0.95, 1.1, 1.03])
    again = fit(problem, replace(fitted.point, derivatives=shifted), fitted.noise)
    assert again.cost == pytest.approx(fitted.cost, abs=1.0)
    assert again.iterations <= 5
    strong = [0, 3, 4, 5]
    assert again.point.derivatives[strong] == pytest.approx(fitted.point.derivatives[strong], rel=0.01)


def test_a_search_that_is_out_of_reach_of_another_is_given_up_and_no_other(settled):
    problem, fitted = settled
    shifted = replace(fitted.point, derivatives=fitted.point.derivatives * 1.1)
    ended = fit(problem, shifted, fitted.noise)
    assert fit(problem, shifted, fitted.noise, beaten_by=ended.cost).cost == ended.cost
    far = fit(problem, shifted, fitted.noise, beaten_by=fitted.cost - 1e6)
    assert far.iterations == 1


def test_manoeuvres_that_are_set_aside_have_no_say(settled):
    problem, plain = settled
    flights = replace(problem.flights, flights=problem.flights.flights[:2])
    two = replace(problem, flights=flights, base=problem.base[:2])
    point = replace(plain.point, derivatives=1.1 * plain.point.derivatives)
    of_two = replace(point, own=point.own[:2], edges=point.edges[:2])
    alone = fit(two, of_two, plain.noise, 25, 1e-3)
    aside = fit(problem, point, plain.noise, 25, 1e-3, aside=(2,))
    told, due, of_all = (f.point.derivatives for f in (aside, alone, plain))
    # The noise counts all samples: what the data hardly tell depends on it a little.
    std = np.sqrt(np.diag(np.linalg.inv(alone.information)))[: len(due)]
    assert np.all(np.abs(told - due) < np.maximum(3e-3 * np.abs(due), 0.1 * std))
    assert np.any(np.abs(due / of_all - 1.0) > 1e-2)


def test_products_of_columns_tell_the_squares_that_rows_do(settled):
    problem, fitted = settled
    random = np.random.default_rng(3)
    for flight, block in zip(problem.flights.flights, fitted.linear, strict=True):
        step, own = random.normal(size=block.shared.shape[1]), random.normal(size=block.own.shape[1])
        after = block.after(step, own)
        due = [after[rows] @ after[rows] for rows in problem.rows(flight)]
        assert block.squares_after(step, own) == pytest.approx(due)


def test_own_numbers_are_eliminated_as_least_squares_of_the_rows_would(settled):
    problem, fitted = settled
    weights, block = 1.0 / fitted.noise, fitted.linear[0]
    w = row_weights(problem, 0, weights)
    rows = np.vstack([block.own * w[:, None], np.diag(np.sqrt(block.prior))])
    left = np.concatenate([block.residual * w, np.sqrt(block.prior) * block.departure])
    least = np.linalg.lstsq(rows, left)[1]
    inner, follow = own_eliminated(block, weights)
    assert inner[-1, -1] + block.prior @ block.departure**2 == pytest.approx(least, rel=1e-6)
    assert np.sum((left - rows @ follow[:, -1]) ** 2) == pytest.approx(least, rel=1e-6)


@pytest.mark.parametrize("effect", ["transport_delay", "actuator_lag", "alpha_skew"])
def test_the_coarser_grid_of_the_screening_tells_what_the_fits_own_grid_does(settled, effect):
    problem, plain = settled
    variant = next(v for v in variants_for(problem.flights) if v.effect == effect)
    # Of flights with every step halved the coarser grid is that of the fit.
    halved = tuple(
        replace(f, h=0.5 * f.h, n=2 * f.n, slow=np.repeat(f.slow, 2, axis=1)) for f in problem.flights.flights
    )
    fine = replace(problem, flights=replace(problem.flights, flights=halved))
    points = [plain.point.with_effect(variant, (value,)) for value in (0.0, 0.03)]
    told, due = ([place.cost for place in Neighbourhood(p, plain).at_all(points)] for p in (problem, fine))
    assert told[0] == pytest.approx(due[0], abs=0.5)
    assert due[1] > plain.cost + 1000.0
    assert told[1] - plain.cost == pytest.approx(due[1] - plain.cost, rel=0.02)


@pytest.mark.parametrize("late_s", [0.0, 0.0013, 0.0037])
def test_a_jump_of_a_held_command_is_where_it_is_and_not_spread_over_the_grid(settled, late_s):
    problem, plain = settled
    held = replace(problem, held=True)
    flight = problem.flights.flights[0]
    fine = replace(flight, h=flight.h / 8.0, n=8 * flight.n, slow=np.repeat(flight.slow, 8, axis=1))
    [p] = held.driving(plain.point)[:1]
    p[INDEX["latency_s"]], p[INDEX["lag_s"]] = late_s, 0.0
    a_z, due = held.fly(flight, p)[OUTPUTS.index("a_z")], held.fly(fine, p)[OUTPUTS.index("a_z")][::8]
    assert np.max(np.abs(np.diff(due))) > 0.5
    np.testing.assert_allclose(a_z, due, atol=0.03)


def test_a_search_ends_where_no_shift_of_time_leaves_less_though_edges_lie_far_from_their_stamps():
    """Answers to the edges of a command logged 25 times a second shift with it, by as much as noise shows."""
    early = Setup(maneuvers=4, rate_hz=25.0, noise=0.003, skew={"a_z": -0.02}, seed=2)
    problem, plain = fit_baseline(prepare(fly(early), Aircraft()), Aircraft())
    skew = next(v for v in variants_for(problem.flights) if v.effect == "accelerometer_skew")
    begun = [plain.point.with_effect(skew, (skew_s,)) for skew_s in (-0.02, 0.01)]
    near, far = (fit(problem, point, plain.noise, 30, 0.01) for point in begun)
    assert near.cost == pytest.approx(far.cost, abs=0.5)
    assert near.point.values[-1] == pytest.approx([-0.02], abs=0.001)
    latency = len(plain.point.derivatives)
    for later_s in (-0.0003, 0.0003):
        shared = near.point.shared.copy()
        shared[latency] += later_s
        there = fit(problem, near.point.moved(shared, near.point.own), near.noise, iterations=1)
        assert there.cost > near.cost + 1.0


def test_only_a_time_has_the_error_of_a_grid_of_time_in_its_size(settled):
    problem, _ = settled

    def doubted(effect, name, value):
        cause = Cause(effect, "timing", 0.9, {name: Value(value, 1e-5)}, (), "", 0.0, True)
        return with_model_errors(cause, problem).parameters[name].std

    assert doubted("pitch_rate_bias", "bias_rad_s", 0.004) == pytest.approx(0.03 * 0.004, rel=0.01)
    assert doubted("alpha_skew", "skew_s", 0.004) > 3.0 * 0.03 * 0.004


def test_where_only_a_channel_is_late_nothing_is_flown_again_and_another_delay_is(settled, monkeypatch):
    problem, fitted = settled
    flight, p = problem.flights.flights[0], problem.driving(fitted.point)[0]
    rows = np.tile(p, (4, 1))
    rows[1, INDEX["alpha_skew_s"]] = 0.02
    rows[2, INDEX["delay_s"]] = 0.02
    rows[3, [INDEX["alpha_skew_s"], INDEX["q_skew_s"]]] = 0.03, -0.01
    flown = []
    fly_all = EffectProblem.fly_all
    monkeypatch.setattr(
        EffectProblem, "fly_all", lambda self, f, some: flown.append(len(some)) or fly_all(self, f, some)
    )
    each = [problem.read(flight, problem.fly(flight, row), row) for row in rows]
    flown.clear()
    assert np.array_equal(problem.fly_and_read(flight, rows), np.column_stack(each))
    assert flown == [2]


def test_manoeuvres_without_an_angle_of_attack_are_left_out_where_enough_have_one():
    flown = fly(Setup(maneuvers=5, seed=41))
    blind = replace(flown[2], channels={c: y for c, y in flown[2].channels.items() if c != "alpha"})
    found = prepare([*flown[:2], blind, *flown[3:]], Aircraft())
    assert [f.number for f in found.flights] == [m.number for m in flown if m is not flown[2]]
    assert "alpha" in found.channels
    assert "alpha" not in prepare([*flown[:2], blind], Aircraft()).channels


def test_a_manoeuvres_own_numbers_act_as_they_do_in_flight_where_the_moment_bends():
    flights = prepare(fly(Setup(maneuvers=1, seed=41)), Aircraft())
    problem, flight = EffectProblem(flights, np.zeros(len(ENTRIES))), flights.flights[0]
    derivatives = np.array([-4.0, 0.0, -0.3, -35.0, -4.0, -45.0])
    bent = next(v for v in variants_for(flights) if v.effect == "nonlinear_pitching_moment")
    at = SearchPoint(derivatives, np.array([[0.0, 0.0, -0.44, 0.0]])).with_effect(bent, (0.0, -4000.0))
    own = linearise(problem, at)[0].own
    read = problem.fly_and_read(flight, problem.driving(at)[:1])[:, 0]
    for k, step in enumerate((1e-4, 1e-4, 1e-3, 1e-3)):
        moved = replace(at, own=at.own + step * np.eye(4)[k])
        answer = (problem.fly_and_read(flight, problem.driving(moved)[:1])[:, 0] - read) / step
        np.testing.assert_allclose(own[:, k], answer, rtol=1e-6, atol=1e-9)


def test_a_number_at_its_bound_leaves_the_others_at_their_best_beside_it():
    H, g = np.array([[2.0, 1.9], [1.9, 2.0]]), np.array([1.0, -1.0])
    free = np.linalg.solve(H, g)
    assert solved_within(H, g, np.full(2, -100.0), np.full(2, 100.0)) == pytest.approx(free)
    bounded = solved_within(H, g, np.array([-100.0, -100.0]), np.array([3.0, 100.0]))
    assert bounded == pytest.approx([3.0, (g[1] - H[1, 0] * 3.0) / H[1, 1]])


@pytest.mark.parametrize("which", [*range(6), slice(None)])
def test_a_derivative_of_nothing_in_the_file_has_a_size_that_can_be_weighed(which):
    believed = np.array([-4.3, -0.03, -0.28, -37.0, -4.8, -52.0])
    believed[which] = 0.0
    assert np.all(np.isfinite(prior_precision(believed, ERROR_IF_WRONG)))
