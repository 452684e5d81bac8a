"""Eqs. (10) and (11): which manoeuvres count, and every reading of the paper that had to be decided."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from advisor.decision.paper_rules import continuous_improvement, every_usable, separate_computation
from advisor.decision.verdict import RuleResult

costs_strategy = st.lists(st.one_of(st.none(), st.floats(1e-12, 1e-3)), max_size=12)


def accepted(results: tuple[RuleResult, ...]) -> list[bool]:
    return [result.accepted for result in results]


def test_the_first_manoeuvre_is_accepted_by_both_rules_whatever_it_costs() -> None:
    assert continuous_improvement([5.0]) == (RuleResult(True, None),)
    assert separate_computation([5.0]) == (RuleResult(True, None),)


def test_continuous_improvement_allows_less_than_twice_the_last_cost() -> None:
    assert accepted(continuous_improvement([1.0, 1.999])) == [True, True]
    assert accepted(continuous_improvement([1.0, 2.0])) == [True, False]


def test_continuous_improvement_compares_with_the_last_accepted_manoeuvre_not_the_last_flown() -> None:
    # Compared with the last flown, the second poor manoeuvre would pass beside the first poor one.
    results = continuous_improvement([1.0, 10.0, 10.0, 1.5])
    assert accepted(results) == [True, False, False, True]
    assert [result.limit for result in results] == [None, 2.0, 2.0, 2.0]


def test_a_poor_first_manoeuvre_does_not_shut_out_the_good_ones_after_it() -> None:
    assert accepted(continuous_improvement([100.0, 1.0, 1.5, 100.0])) == [True, True, True, False]
    assert accepted(separate_computation([100.0, 1.0, 0.9])) == [True, True, True]


def test_data_without_noise_are_not_rejected_for_the_last_digit_of_their_cost() -> None:
    assert accepted(continuous_improvement([5e-36, 2e-27, 8e-31])) == [True, True, True]


def test_separate_computation_asks_for_less_than_the_median_of_all_earlier_ones() -> None:
    results = separate_computation([3.0, 1.0, 2.0, 1.5])
    assert [result.limit for result in results] == [None, 3.0, 2.0, 2.0]
    assert accepted(results) == [True, True, False, True]


def test_the_median_holds_the_manoeuvres_the_rule_rejected() -> None:
    # Were the rejected 5 and 6 left out, the limit for the last one would be 1 and it would fail.
    results = separate_computation([1.0, 5.0, 6.0, 4.0])
    assert accepted(results) == [True, False, False, True]
    assert results[-1].limit == 5.0


def test_an_even_number_of_earlier_costs_has_its_median_midway() -> None:
    assert separate_computation([1.0, 3.0, 9.0])[-1].limit == 2.0


def test_a_manoeuvre_equal_to_its_limit_is_not_below_it() -> None:
    assert accepted(separate_computation([1.0, 1.0])) == [True, False]


def test_a_quiet_record_sets_no_limit_because_it_never_reaches_the_rules() -> None:
    with_quiet = [1.0, None, 1.2, 0.8]
    assert accepted(continuous_improvement(with_quiet)) == [True, False, True, True]
    assert continuous_improvement(with_quiet)[2].limit == 2.0
    assert separate_computation(with_quiet)[2].limit == 1.0


def test_an_unusable_first_manoeuvre_leaves_the_second_as_the_first() -> None:
    assert continuous_improvement([None, 7.0]) == (RuleResult(False, None), RuleResult(True, None))
    assert separate_computation([None, 7.0]) == (RuleResult(False, None), RuleResult(True, None))


def test_the_median_rule_throws_away_about_half_of_equally_good_manoeuvres() -> None:
    rng = np.random.default_rng(3)
    campaigns = [separate_computation(list(rng.lognormal(0.0, 0.1, 7))) for _ in range(400)]
    share = np.mean([[not r.accepted for r in results[1:]] for results in campaigns])
    assert math.isclose(share, 0.5, abs_tol=0.04)


def test_the_rule_information_counts_every_usable_manoeuvre() -> None:
    assert accepted(every_usable([1.0, None, 50.0])) == [True, False, True]


@given(costs_strategy)
def test_a_verdict_never_depends_on_manoeuvres_flown_later(costs: list[float | None]) -> None:
    for rule in (continuous_improvement, separate_computation):
        whole = rule(costs)
        assert all(rule(costs[: i + 1])[-1] == whole[i] for i in range(len(costs)))


@given(costs_strategy, st.floats(0.01, 100.0))
def test_only_ratios_of_costs_matter(costs: list[float | None], factor: float) -> None:
    scaled = [None if c is None else 2.0 ** round(math.log2(factor)) * c for c in costs]
    for rule in (continuous_improvement, separate_computation):
        assert accepted(rule(costs)) == accepted(rule(scaled))


def test_costs_below_those_of_a_microradian_count_as_one_cost() -> None:
    assert [one.accepted for one in continuous_improvement([1e-26, 1.9e-24])] == [True, True]
    assert [one.accepted for one in continuous_improvement([1e-26, 2.1e-24])] == [True, False]
