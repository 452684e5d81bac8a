"""Eqs. (10) and (11): which manoeuvres count, and every reading of the paper that had to be decided."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.paper_rules import (
    continuous_improvement,
    every_usable,
    scatter_by_parameter,
    scatter_percent,
    separate_computation,
    window,
)
from advisor.decision.verdict import RuleResult
from tests.decision.campaigns import THETA, estimate
from tests.rows import row

CONTINUOUS, SEPARATE = continuous_improvement, separate_computation
costs_strategy = st.lists(st.one_of(st.none(), st.floats(1e-12, 1e-3)), max_size=12)


def accepted(results: tuple[RuleResult, ...]) -> list[bool]:
    return [result.accepted for result in results]


FIRST = (True, None)


@row("the first is accepted whatever it costs", CONTINUOUS, [5.0], [FIRST])
@row("the first is accepted by the separate rule too", SEPARATE, [5.0], [FIRST])
@row("an unusable first leaves the second as first", CONTINUOUS, [None, 7.0], [(False, None), FIRST])
@row("an unusable one is skipped by the separate rule", SEPARATE, [None, 7.0], [(False, None), FIRST])
# Compared with the last flown, the second poor manoeuvre would pass beside the first poor one.
@row(
    "the last accepted manoeuvre is compared with, not the last flown",
    CONTINUOUS, [1.0, 10.0, 10.0, 1.5], [FIRST, (False, 2.0), (False, 2.0), (True, 2.0)],
)  # fmt: skip
@row(
    "a quiet record sets no limit",
    CONTINUOUS, [1.0, None, 1.2, 0.8], [FIRST, (False, 2.0), (True, 2.0), (True, 2.4)],
)  # fmt: skip
@row(
    "a quiet record is not in the median",
    SEPARATE, [1.0, None, 1.2, 0.8], [FIRST, (False, 1.0), (False, 1.0), (True, 1.1)],
)  # fmt: skip
@row(
    "the separate rule asks for less than the median of all earlier ones",
    SEPARATE, [3.0, 1.0, 2.0, 1.5], [FIRST, (True, 3.0), (False, 2.0), (True, 2.0)],
)  # fmt: skip
# Were the rejected 5 and 6 left out, the limit for the last one would be 1 and it would fail.
@row(
    "the median holds the manoeuvres the rule rejected",
    SEPARATE, [1.0, 5.0, 6.0, 4.0], [FIRST, (False, 1.0), (False, 3.0), (True, 5.0)],
)  # fmt: skip
@row("two costs have their median midway", SEPARATE, [1.0, 3.0, 9.0], [FIRST, (False, 1.0), (False, 2.0)])
def test_what_a_rule_accepts_and_by_which_limit(rule, costs, expected) -> None:
    assert [(result.accepted, result.limit) for result in rule(costs)] == expected


POOR_FIRST = [100.0, 1.0, 1.5, 100.0]


@row("less than twice the last cost is allowed", CONTINUOUS, [1.0, 1.999], [True, True])
@row("twice the last cost is not allowed", CONTINUOUS, [1.0, 2.0], [True, False])
@row("a poor first manoeuvre shuts no good one out", CONTINUOUS, POOR_FIRST, [True, True, True, False])
@row(
    "a poor first manoeuvre is outlived by the separate rule", SEPARATE, [100.0, 1.0, 0.9], [True, True, True]
)
@row("the last digit of a cost rejects nothing", CONTINUOUS, [5e-36, 2e-27, 8e-31], [True, True, True])
@row("a manoeuvre equal to its limit is not below it", SEPARATE, [1.0, 1.0], [True, False])
@row("information counts every usable manoeuvre", every_usable, [1.0, None, 50.0], [True, False, True])
@row("costs below a microradian's count as one", CONTINUOUS, [1e-26, 1.9e-24], [True, True])
@row("costs above a microradian's are their own", CONTINUOUS, [1e-26, 2.1e-24], [True, False])
def test_which_manoeuvres_a_rule_accepts(rule, costs, expected) -> None:
    assert accepted(rule(costs)) == expected


def test_the_median_rule_throws_away_about_half_of_equally_good_manoeuvres() -> None:
    rng = np.random.default_rng(3)
    campaigns = [separate_computation(list(rng.lognormal(0.0, 0.1, 7))) for _ in range(400)]
    share = np.mean([[not r.accepted for r in results[1:]] for results in campaigns])
    assert math.isclose(share, 0.5, abs_tol=0.04)


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


def test_one_scattering_parameter_counts_five_standard_deviations_over_its_mean() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 5] = [-4.0, -5.0, -6.0]  # sample standard deviation 1, mean -5
    assert scatter_percent(theta) == pytest.approx(100.0)


def test_the_criterion_is_the_euclidean_norm_over_all_eight_parameters() -> None:
    theta = np.outer([0.9, 1.0, 1.1], THETA)  # every parameter scatters by 10 %
    assert scatter_percent(theta) == pytest.approx(50.0 * np.sqrt(8.0))


def test_the_sign_of_a_mean_does_not_matter() -> None:
    theta = np.random.default_rng(0).normal(1.0, 0.1, (3, 8))
    assert scatter_percent(theta) == pytest.approx(scatter_percent(theta * [1, -1, 1, -1, -1, 1, -1, 1]))


def test_the_written_out_form_takes_squared_deviations_over_n_times_the_mean() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 5] = [-4.0, -5.0, -6.0]
    assert scatter_percent(theta, "eq13") == pytest.approx(100.0 * 5.0 * 2.0 / (3.0 * 5.0))


def test_the_written_out_form_depends_on_units_and_the_default_does_not() -> None:
    theta = np.random.default_rng(1).normal(1.0, 0.1, (3, 8))
    assert scatter_percent(10.0 * theta) == pytest.approx(scatter_percent(theta))
    assert scatter_percent(10.0 * theta, "eq13") == pytest.approx(10.0 * scatter_percent(theta, "eq13"))


def test_a_parameter_whose_mean_is_zero_has_no_scale() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 2] = [-1.0, 0.0, 1.0]
    assert np.isinf(scatter_by_parameter(theta)[2])


def test_equal_estimates_do_not_scatter_even_at_zero() -> None:
    assert scatter_percent(np.zeros((3, 8))) == 0.0


def test_the_window_holds_the_last_n_members_so_that_three_manoeuvres_suffice() -> None:
    plan = CampaignPlan(window=3)
    estimates = [estimate(k * THETA) for k in (1.0, 2.0, 3.0, 4.0)]
    assert window(estimates[:2], plan) is None
    members = window(estimates, plan)
    assert members is not None
    np.testing.assert_allclose(members, [2.0 * THETA, 3.0 * THETA, 4.0 * THETA])


def test_the_window_brings_estimates_to_one_air_speed() -> None:
    fast = THETA * [1.0, 1.2, 1.0, 1.2, 1.0, 1.44, 1.2, 1.44]
    estimates = [estimate(THETA, airspeed_m_s=25.0), estimate(fast, airspeed_m_s=30.0)]
    members = window(estimates, CampaignPlan(window=2))
    assert members is not None
    derivatives = [1, 2, 3, 5, 6, 7]
    np.testing.assert_allclose(members[0, derivatives], members[1, derivatives])
