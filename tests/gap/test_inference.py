"""Every explanation is a row with its parts in nats; their posterior is the answer."""

from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.alternative import Alternative
from advisor.gap.candidates.known import variants_for
from advisor.gap.inference.diagnose import _named_air
from advisor.gap.inference.engine import _lead, decided, first_stage
from advisor.gap.inference.explanation import Evidence, Explanation, Row
from advisor.gap.inference.marginal import Prior, marginal
from advisor.gap.inference.posterior import (
    NONE,
    PARAMETERS,
    UNKNOWN,
    _pairs,
    _with_residual,
    posterior_of,
    rows_of,
    stated_as,
)
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.residual import Residual
from advisor.gap.inference.sizes import natural_nats, natural_shares, with_sizes
from advisor.gap.inference.stage import Stage, stage_of, within_model_error
from advisor.gap.records.prepare import prepare
from advisor.gap.verdict.reasons import capped, weighed
from advisor.process.parts import Parts
from advisor.report.gap_causes import decision_in_words
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

MOMENT = Alternative("unknown", "unknown", "moment_equation")
LIFT = Alternative("unknown", "unknown", "force_equation")
DELAY, LAG = stated_as("transport_delay"), stated_as("actuator_lag")
EVERY = (NONE, PARAMETERS, MOMENT, LIFT, DELAY, LAG)


def row(alternative, fit=0.0, prior=0.0):
    return Row(alternative, SimpleNamespace(name=alternative.name), {"prior": prior, "fit": fit})


@given(st.lists(st.floats(-1e4, 1e4), min_size=6, max_size=6))
def test_the_answer_is_the_likeliest_with_all_blocks_of_the_unknown_together(nats):
    told = posterior_of(map(row, EVERY, nats))
    each = {}
    for alternative, p in told.by_alternative.items():
        each[alternative.name] = each.get(alternative.name, 0.0) + p
    assert sum(each.values()) == pytest.approx(1.0)
    assert each[told.answer.name] == pytest.approx(max(each.values()))


def test_two_blocks_of_the_unknown_outweigh_one_likelier_effect():
    told = posterior_of([row(DELAY, 1.0), row(MOMENT, 0.7), row(LIFT, 0.6)])
    assert told.answer == MOMENT


def test_two_ways_of_one_answer_add_up():
    told = posterior_of([row(NONE), row(DELAY), row(DELAY)])
    assert told.of(DELAY) == pytest.approx(2.0 / 3.0)


@given(st.lists(st.floats(-500.0, 500.0), min_size=6, max_size=6))
def test_the_reasons_add_up_to_the_log_odds_even_where_the_rival_has_no_chance(nats):
    told = posterior_of(map(row, EVERY, nats))
    said = weighed(told)
    parts = [part.nats for part in said.why]
    names = told.answer.name, said.rival.partition("@")[0]
    mine, other = (
        np.logaddexp.reduce([r.weight for r in told.rows if r.alternative.name == n]) for n in names
    )
    assert sum(parts) == pytest.approx(mine - other, abs=1e-6)


@pytest.mark.parametrize("answer", EVERY)
def test_every_decision_on_an_answer_has_a_sentence(answer):
    told = posterior_of([row(answer, 3.0), *(row(other) for other in EVERY if other != answer)])
    lines = [decision_in_words(one) for one in weighed(told).decisions]
    # The rival, or the answer, is both blocks of the unknown together.
    odds = "3.05" if answer.kind == "unknown" else "2.31"
    assert lines[0].endswith(f"its log odds against the next answer are {odds} nats (at least 0)")
    assert "its probability is" in lines[1]


def gaussian(information, gradient, prior):
    """Return the log of the integral of a Gaussian likelihood times a Gaussian prior, up to a constant."""
    whole = information + np.diag(prior.precision)
    slope = gradient + prior.precision * prior.pull
    volume = np.sum(np.log(prior.precision)) - np.linalg.slogdet(whole)[1]
    return 0.5 * (volume + slope @ np.linalg.solve(whole, slope) - prior.precision @ prior.pull**2)


def test_the_evidence_of_wrong_derivatives_is_the_mean_over_all_sets_of_them():
    rng = np.random.default_rng(3)
    root, gradient, pull = rng.normal(size=(9, 4)), 3.0 * rng.normal(size=4), rng.normal(size=4)
    tight, loose, stated = np.array([30.0, 20.0, 5.0, 40.0]), np.array([0.3, 0.2, 5.0, 0.4]), [0, 1, 3]
    told = marginal(2.0, root.T @ root, gradient, Prior(tight, pull), Prior(loose, pull))
    each, weights = [], []
    for wrong in product((False, True), repeat=3):
        precision = tight.copy()
        precision[[k for k, off in zip(stated, wrong, strict=True) if off]] = [
            loose[k] for k, off in zip(stated, wrong, strict=True) if off
        ]
        each.append(2.0 + gaussian(root.T @ root, gradient, Prior(precision, pull)))
        one_right = 0.5 ** (1.0 / 3.0)
        weights.append(np.prod(np.where(wrong, 1.0 - one_right, one_right)))
    assert weights[0] == pytest.approx(0.5)
    assert told.right == pytest.approx(each[0])
    assert told.wrong == pytest.approx(np.log(np.dot(weights[1:], np.exp(each[1:])) / 0.5))


class Model(SimpleNamespace):
    """An explanation with a log likelihood, whose change of the outputs by its effect is nothing."""

    unseen = 0.0

    def lifted(self, nats):
        return Model(likelihood=self.likelihood + nats)


@pytest.mark.parametrize(("apart", "nats"), [(0.0, 0.0), (0.0025, 5.0), (0.005, 20.0), (0.05, 1000.0)])
def test_a_difference_below_a_simulators_own_error_decides_by_few_nats(apart, nats):
    """The error is half a per cent of the peak, with forty independent numbers: 20 nats at its size."""
    flight = SimpleNamespace(apart=lambda one, other: apart)
    best, other = (Model(likelihood=likelihood, form_error=0.0) for likelihood in (1000.0, 0.0))
    told = within_model_error(flight, [best, other], 0.0)
    assert told[0].likelihood - told[1].likelihood == pytest.approx(nats)


@pytest.mark.parametrize(("size", "likelier"), [(1.0, True), (3.2, True), (3.7, False), (10.0, False)])
def test_a_residual_far_beyond_a_simulators_own_is_likelier_of_a_law_without_a_name(size, likelier):
    prior = FieldPrior(none=0.25, parameters=0.25, effect=0.25, unknown=0.25)
    rows = list(_with_residual(row(DELAY), Residual(size, {"moment_equation": 1.0}), prior))
    assert [r.alternative for r in rows] == [DELAY, MOMENT]
    assert (rows[0].weight > rows[1].weight) is likelier


@given(st.floats(0.25, 50.0))
def test_a_residual_that_moving_air_explains_is_no_law_without_a_name(size):
    prior = FieldPrior(none=0.25, parameters=0.25, effect=0.25, unknown=0.25)
    rows = list(_with_residual(row(DELAY), Residual(size, {"air": 1.0}), prior))
    assert {r.alternative for r in rows} == {DELAY}


def named_in_moving_air(alternative, left):
    """Return the row of an answer in moving air that leaves 1 of what the answer leaves of a gap of 10."""

    def mean_square(gap):
        return SimpleNamespace(mean_square=np.array([1.0 + gap]))

    air = SimpleNamespace(
        is_natural=False, gust=False, angle_std=0.02, mean_square_beyond_air=np.array([2.0]), steady=-3.0
    )
    model = SimpleNamespace(name="", held_out=mean_square(left))
    plain = SimpleNamespace(held_out=mean_square(10.0))
    rows = [Row(alternative, model, {"fit": 0.0})]
    (told,) = _named_air(rows, plain, SimpleNamespace(found=air), 0.0, np.ones(1))
    return told


@pytest.mark.parametrize(("left", "named"), [(2.0, DELAY), (8.0, stated_as("turbulence"))])
def test_an_effect_in_moving_air_has_the_name_of_the_cause_that_removes_more_of_the_gap(left, named):
    assert named_in_moving_air(DELAY, left).alternative == named


@pytest.mark.parametrize("answer", [PARAMETERS, MOMENT])
def test_moving_air_never_takes_the_answer_from_wrong_numbers_or_from_a_law_without_a_name(answer):
    told = named_in_moving_air(answer, 8.0)
    assert (told.alternative, told.weight) == (answer, 0.0)


def test_right_derivatives_in_moving_air_are_turbulence_that_rests_less_with_the_elevator():
    told = named_in_moving_air(NONE, 8.0)
    assert (told.alternative, told.weight) == (stated_as("turbulence"), -3.0)


def explanation(alternative=None, nats=0.0, **more):
    """Return an explanation of so many nats, likewise with right and with wrong derivatives."""
    told = Evidence(nats, nats)
    name = "" if alternative is None else alternative.name
    return Explanation(
        alternative=alternative, name=name, evidence=told, natural=told.more(-50.0), likelihood=nats, **more
    )


SPREAD = FieldPrior(none=0.3, parameters=0.3, effect=0.3, unknown=0.1)


class Flight:
    """A flight whose models are made by hand; ``table`` has an effect by its name."""

    is_stated, tried, parts, maneuvers = True, (3, 0), Parts(), 3

    def __init__(self, nats, second=(), residual=0.5, moving=None, together=()):
        self.nats, self.second, self.left, self.moving = nats, dict(second), residual, moving
        self.together, self.asked = dict(together), []

    def explained(self, base, most):
        self.asked.append((base and base.name, most))
        added = self.second if base else self.nats
        told = [explanation(stated_as(name), nats) for name, nats in added.items()]
        return 1.0, [explanation(), *told]

    def at_the_files(self, one, plain, heat):
        return None

    def apart(self, one, other):
        return 1.0

    def residual(self, one, heat):
        return Residual(self.left, {"moment_equation": 1.0}, 0.5)

    def natural_nats(self, lead, pair):
        return -50.0

    def in_moving_air(self, stage):
        if self.moving is None:
            return None
        return Stage(explanation(None, self.moving), (), (), stage.heat)

    def pairs(self, stage, leads):
        yield from ((-gain, *names) for names, gain in self.together.items())


def test_an_axis_without_moving_air_has_no_way_in_it():
    flight = Flight({"actuator_lag": 8.0})
    rows = rows_of(flight, stage_of(flight, None, 6), SPREAD)
    assert not any(row.in_moving_air for row in rows)


@pytest.mark.parametrize(("moving", "likeliest"), [(-20.0, False), (20.0, True)])
def test_a_flight_in_moving_air_is_a_rival_of_one_in_still_air(moving, likeliest):
    flight = Flight({"actuator_lag": 8.0}, moving=moving)
    told = posterior_of(rows_of(flight, stage_of(flight, None, 6), SPREAD))
    assert told.rows[0].in_moving_air is likeliest


def test_moving_air_is_as_likely_before_the_flight_as_any_one_of_three_effects():
    flight = Flight({}, moving=0.0)
    told = rows_of(flight, stage_of(flight, None, 6), SPREAD)
    still, moving = (
        max(r.weight for r in told if r.alternative == NONE and r.in_moving_air is moves)
        for moves in (False, True)
    )
    assert moving - still == pytest.approx(np.log(0.1 / 0.3))


@pytest.mark.parametrize(("behind", "fitted"), [(100.0, True), (140.0, False)])
def test_an_effect_that_a_wrong_derivative_hides_is_fitted_at_the_files_derivatives_within_reach(
    behind, fitted
):
    """The reach is 120 nats behind the best explanation."""
    flight = Flight({"transport_delay": 0.0, "actuator_lag": -behind})
    flight.apart = lambda one, other: 1e9
    flight.at_the_files = lambda one, plain, heat: replace(one, evidence=Evidence(5.0, -behind))
    told = {one.name: one.evidence.right for one in stage_of(flight, None, 6).effects}
    assert told["actuator_lag"] == (5.0 if fitted else -behind)


def test_what_moving_air_explains_is_no_law_without_a_name_where_the_air_moves():
    """The residual is far beyond a simulator's own in still air, and within it beside the air."""
    flight = Flight({}, residual=12.0, moving=5.0)
    told = posterior_of(rows_of(flight, stage_of(flight, None, 6), SPREAD))
    assert told.of(MOMENT) < 0.1
    still = Flight({}, residual=12.0)
    told = posterior_of(rows_of(still, stage_of(still, None, 6), SPREAD))
    assert told.of(MOMENT) > 0.9


@pytest.mark.parametrize(("behind", "searched"), [(2.0, True), (40.0, False)])
def test_an_alternative_that_may_be_the_answer_is_judged_by_its_own_residual(behind, searched):
    """Fitted derivatives leave thirty times a simulator's own residual, and the lag leaves none."""
    flight = Flight({"actuator_lag": -behind})
    flight.residual = lambda one, heat: Residual(0.5 if one.name else 30.0, {"moment_equation": 1.0})
    rows = rows_of(flight, stage_of(flight, None, 6), SPREAD)
    named, left_alone = (
        next(row for row in rows if row.alternative == alternative) for alternative in (LAG, NONE)
    )
    assert (named.terms["residual"] > left_alone.terms["residual"] + 5.0) is searched


def test_a_residual_that_scatters_by_its_own_size_tells_nothing_of_a_law():
    """Seven times a simulator's own residual is 4.4 nats for a law that is missing, if the size is exact."""
    right, lacking = Residual(7.0, {}, error=49.0, freedom=2).nats(in_moving_air=False)
    assert lacking - right < 1.5


@pytest.mark.parametrize("size", [0.6, 1.0, 7.0])
def test_a_residual_that_hardly_scatters_counts_as_an_exact_one(size):
    exact = Residual(size, {}).nats(in_moving_air=False)
    assert Residual(size, {}, error=0.05 * size**2, freedom=30).nats(False) == pytest.approx(exact, abs=0.1)


def test_a_second_effect_is_sought_after_the_first():
    flight = Flight({"transport_delay": 60.0}, {"actuator_lag": 20.0})
    found = decided(flight, first_stage(flight), SPREAD, lambda rows: rows)
    assert [one.name for one in found.chosen] == ["", "transport_delay", "actuator_lag"]
    assert flight.asked == [(None, 6), ("transport_delay", 3)]


def test_without_an_effect_as_the_answer_no_second_one_is_sought():
    flight = Flight({"transport_delay": -60.0})
    found = decided(flight, first_stage(flight), SPREAD, lambda rows: rows)
    assert len(flight.asked) == len(found.posteriors) == 1


class SlowerSimulator(Flight):
    """A flight next to a user's simulator whose servo is slower than the aircraft's."""

    def __init__(self, nats, without, chance=1.0):
        super().__init__(nats)
        self.without = replace(explanation(LAG, without), name="", chance=chance)

    def explained(self, base, most):
        heat, told = super().explained(base, most)
        return heat, [*told, self.without]


@pytest.mark.parametrize("chance", [1.0, 0.4])
def test_a_simulator_without_its_own_effect_is_as_likely_before_the_flight_as_any_effect(chance):
    flight = SlowerSimulator({}, 7.0, chance)
    ways = [r for r in rows_of(flight, stage_of(flight, None, 6), SPREAD) if r.alternative == LAG]
    assert ways[0].terms["prior"] == pytest.approx(np.log(chance * 0.3 / 3))
    assert ways[0].terms["fit"] == 7.0


@pytest.mark.parametrize(("without", "answer"), [(60.0, LAG), (-60.0, NONE)])
def test_a_simulator_without_its_own_effect_is_the_answer_by_its_likelihood_and_nothing_is_added(
    without, answer
):
    flight = SlowerSimulator({"transport_delay": -9.0}, without)
    found = decided(flight, first_stage(flight), SPREAD, lambda rows: rows)
    assert found.posteriors[0].answer == answer
    assert [one.name for one in found.chosen] == [""]
    assert flight.asked == [(None, 6)]


def test_the_effect_that_explains_most_with_a_second_one_leads():
    both = {("transport_delay", "actuator_backlash"): 50.0, ("actuator_lag", "transport_delay"): 20.0}
    flight = Flight({"transport_delay": 5.0, "actuator_lag": 9.0}, together=both)
    assert _lead(flight, stage_of(flight, None, 6)).name == "transport_delay"


def staged(plain, effects=(), laws=(), best=None, small=-50.0):
    """Return a stage of explanations with their log evidence by name, by ``small`` more if natural."""

    def made(name, nats):
        alternative = MOMENT if (name, nats) in laws else stated_as(name) if name else None
        told = Evidence(nats, nats)
        return SimpleNamespace(name=name, alternative=alternative, evidence=told, natural=told.more(small))

    nothing, some, others = made("", plain), [made(*e) for e in effects], [made(*e) for e in laws]
    return SimpleNamespace(plain=nothing, effects=some, laws=others, best=some[0] if some else nothing)


def pairs(first_nats, second, natural=-50.0, alone=()):
    """Return the ways with a delay of so many nats and a second cause, with ``natural`` for a small delay."""
    stage_1 = staged(0.0, [("transport_delay", first_nats)])
    way = Row(DELAY, stage_1.best, {"fit": first_nats})
    prior = FieldPrior(none=0.4, parameters=0.2, effect=0.3, unknown=0.1)
    ways = [way, *(Row(one, SimpleNamespace(), {}) for one in alone)]
    flight = SimpleNamespace(tried=(26, 18), is_stated=True, natural_nats=lambda lead, pair: natural)
    return list(_pairs(flight, ways, stage_1.plain, stage_1.best, second, prior))


def test_a_second_cause_keeps_the_first_one_as_the_answer():
    way = max(pairs(50.0, staged(0.0, [("actuator_lag", 20.0)])), key=lambda way: way.weight)
    assert way.alternative == DELAY
    assert way.model.name == "actuator_lag"
    assert way.terms["second"] == pytest.approx(20.0 + np.log(0.3 / 25 / 0.6))


@pytest.mark.parametrize(("natural", "named"), [(5.0, LAG), (-5.0, DELAY)])
def test_a_pair_whose_first_effect_is_as_small_as_on_every_aircraft_has_the_name_of_the_second(
    natural, named
):
    told = posterior_of(pairs(50.0, staged(0.0, [("actuator_lag", 20.0)]), natural, [LAG]))
    assert told.answer == named


@pytest.mark.parametrize(("small", "named"), [(10.0, NONE), (-10.0, LAG)])
def test_two_effects_that_are_both_as_small_as_on_every_aircraft_are_no_finding(small, named):
    told = posterior_of(pairs(50.0, staged(0.0, [("actuator_lag", 20.0)], small=small), 10.0, [LAG]))
    assert told.answer == named


@pytest.mark.parametrize(("natural", "unknown"), [(20.0, True), (-20.0, False)])
def test_a_law_next_to_an_effect_as_small_as_on_every_aircraft_is_the_answer(natural, unknown):
    told = posterior_of(pairs(990.0, staged(0.0, laws=[("damping_curve", 10.0)]), natural))
    assert (told.answer.kind == "unknown") is unknown


@given(st.floats(0.02, 0.5), st.floats(0.0, 3.0))
def test_a_small_size_is_rather_natural_and_a_large_one_rather_an_effect(share, size):
    """Two Gaussian densities of widths 1 and ``share`` are equal at this size."""
    equal = np.sqrt(-2.0 * np.log(share) / (share**-2 - 1.0))
    assert (natural_nats(np.array([size]), np.ones(1), np.array([share])) > 0.0) == (size < equal)


@pytest.mark.parametrize(("maneuvers", "unknown"), [(2, False), (3, True)])
def test_a_law_without_a_name_needs_three_manoeuvres_that_show_it(maneuvers, unknown):
    flight = Flight({}, residual=12.0)
    flight.maneuvers = maneuvers
    told = posterior_of(rows_of(flight, stage_of(flight, None, 6), SPREAD))
    assert (told.of(MOMENT) > 0.5) is unknown


@pytest.mark.parametrize(("first", "unknown"), [(990.0, 0.01), (30.0, 0.25)])
def test_an_effect_that_leaves_much_to_a_law_is_rather_one_law_without_a_name(first, unknown):
    told = posterior_of(pairs(first, staged(0.0, laws=[("damping_curve", 10.0)])))
    assert told.of(MOMENT) == pytest.approx(unknown)
    assert told.of(DELAY) == pytest.approx(1.0 - unknown)


def test_play_differs_from_servo_to_servo_three_times_as_much_as_other_effects():
    def error(*names):
        return explanation(numbers=names, change=0.2).form_error

    assert error("half_width_rad") == pytest.approx(0.02)
    assert error("lag_s") == pytest.approx(0.006)


@pytest.mark.parametrize(
    ("effect", "share"),
    [
        ("actuator_lag", 0.2),
        ("transport_delay", 0.2),
        ("actuator_deadband", 0.15),
        ("pitch_rate_scale", 0.1),
        ("alpha_vane_offset", 0.02),
    ],
)
def test_the_natural_size_of_servo_and_gyro_is_that_of_their_data_sheets(effect, share):
    variant = SimpleNamespace(effect=effect, names=("size", "at_rad"), places=("at_rad",))
    assert natural_shares(variant) == pytest.approx([share, 1.0])


@pytest.mark.parametrize("gap", [2.0, 5.0, 40.0])
def test_with_a_gap_of_two_no_gap_is_at_most_five_per_cent(gap):
    sure = posterior_of([row(NONE, 50.0), row(PARAMETERS), row(MOMENT)])
    assert capped(sure, gap, 0.0).of(NONE) == pytest.approx(0.05)


def test_what_the_cap_takes_goes_to_the_numbers_as_far_as_fitted_ones_remove_the_gap():
    told = capped(posterior_of([row(NONE, 50.0), row(PARAMETERS), row(MOMENT)]), 10.0, 4.0)
    assert told.of(PARAMETERS) == pytest.approx(0.95 * 0.6)
    assert told.of(MOMENT) == pytest.approx(0.95 * 0.4)


def test_what_the_cap_takes_without_a_file_and_with_two_manoeuvres_is_in_the_likeliest_effects_block():
    told = capped(posterior_of([row(NONE, 50.0), row(DELAY), row(LAG, -9.0)]), 3.0, 3.0)
    assert told.of(PARAMETERS) == 0.0
    assert told.of(replace(UNKNOWN, block=DELAY.block)) == pytest.approx(0.95)


@given(st.floats(0.0, 1.99), st.lists(st.floats(-20.0, 20.0), min_size=6, max_size=6))
def test_below_a_gap_of_two_the_evidence_alone_says_how_likely_no_gap_is(gap, nats):
    told = posterior_of(map(row, EVERY, nats))
    assert capped(told, gap, 0.0) == told


def test_the_cap_leaves_an_answer_that_is_less_likely_as_it_is():
    told = posterior_of([row(NONE, -5.0), row(PARAMETERS), row(MOMENT)])
    assert capped(told, 40.0, 0.0) == told


def test_every_number_of_every_effect_has_a_width_that_follows_the_aircraft():
    flights = prepare(fly(Setup(maneuvers=3, seed=4)), Aircraft())
    derivatives = np.array([-4.0, 0.0, -0.4, -40.0, -5.0, -60.0])
    sized = [with_sizes(v, derivatives, flights) for v in variants_for(flights)]
    assert all(len(v.prior_std) == len(v.names) and min(v.prior_std) > 0.0 for v in sized)
    faster = [with_sizes(v, 4.0 * derivatives, flights) for v in variants_for(flights)]
    moments = [(a, b) for a, b in zip(sized, faster, strict=True) if "M_delta2" in a.names]
    assert all(b.prior_std[0] == pytest.approx(4.0 * a.prior_std[0]) for a, b in moments)


@pytest.mark.study
@pytest.mark.parametrize(
    ("switches", "answer"), [({"delay": 0.06}, "transport_delay"), ({}, "none")], ids=["delay", "nothing"]
)
def test_the_engine_of_evidence_names_what_was_withheld(switches, answer):
    found = diagnose(fly(Setup(maneuvers=6, switches=switches, seed=23)), Aircraft())
    assert (found.causes[0].effect if found.verdict == "effect" else found.verdict) == answer
    assert found.probabilities is not None
