"""Manoeuvres combined by their information: equal to least squares over all of them at once."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.information import outliers
from advisor.decision.pooling import (
    DERIVATIVES,
    INTERCEPTS,
    Pooled,
    Posterior,
    disagreement,
    pool,
    pooled,
    pooled_on_both_sides,
    pooled_without_each,
    posteriors_at_one_speed,
)
from advisor.process.arrays import FloatArray
from tests.campaign.side_builders import estimate as side_estimate
from tests.decision.campaigns import THETA, drawn, estimate, with_change
from tests.rows import row


def random_posterior(rng: np.random.Generator, theta: FloatArray = THETA) -> Posterior:
    root = rng.standard_normal((8, 8)) * np.abs(THETA)[:, None] * 0.05
    covariance = root @ root.T
    return Posterior(rng.multivariate_normal(theta, covariance), covariance)


def test_pooling_equals_generalised_least_squares_with_shared_derivatives_and_own_intercepts() -> None:
    rng = np.random.default_rng(4)
    posteriors = [random_posterior(rng) for _ in range(4)]
    # Unknowns: six derivatives, then (Z_0, M_0) of each manoeuvre.
    columns = 6 + 2 * len(posteriors)
    design = np.zeros((8 * len(posteriors), columns))
    weight = np.zeros((8 * len(posteriors), 8 * len(posteriors)))
    for m, posterior in enumerate(posteriors):
        rows = slice(8 * m, 8 * m + 8)
        for j, k in enumerate(DERIVATIVES):
            design[8 * m + k, j] = 1.0
        for j, k in enumerate(INTERCEPTS):
            design[8 * m + k, 6 + 2 * m + j] = 1.0
        weight[rows, rows] = np.linalg.inv(posterior.covariance)
    normal = design.T @ weight @ design
    solution = np.linalg.solve(normal, design.T @ weight @ np.concatenate([b.theta for b in posteriors]))
    covariance = np.linalg.inv(normal)
    mean = np.zeros((8, columns))
    mean[list(DERIVATIVES), range(6)] = 1.0
    for j, k in enumerate(INTERCEPTS):
        mean[k, 6 + j :: 2] = 1.0 / len(posteriors)

    pooled = pool(posteriors)
    np.testing.assert_allclose(pooled.theta, mean @ solution, rtol=1e-6)
    np.testing.assert_allclose(pooled.covariance, mean @ covariance @ mean.T, rtol=1e-5, atol=1e-12)


def test_one_manoeuvre_pools_to_itself() -> None:
    posterior = random_posterior(np.random.default_rng(5))
    pooled = pool([posterior])
    np.testing.assert_allclose(pooled.theta, posterior.theta, rtol=1e-6)
    np.testing.assert_allclose(pooled.covariance, posterior.covariance, rtol=1e-5, atol=1e-12)


def test_a_manoeuvre_that_cannot_know_a_parameter_leaves_it_to_the_others() -> None:
    blind = np.diag((0.01 * THETA) ** 2)
    blind[2, 2] = np.inf
    theta = THETA.copy()
    theta[2] = np.nan
    seeing = Posterior(THETA, np.diag((0.01 * THETA) ** 2))
    pooled = pool([Posterior(theta, blind), seeing])
    assert pooled.theta[2] == pytest.approx(THETA[2])
    assert pooled.std[2] == pytest.approx(seeing.std[2])
    assert pooled.std[1] == pytest.approx(seeing.std[1] / np.sqrt(2.0))


def test_what_no_manoeuvre_knows_stays_unknown() -> None:
    covariance = np.diag((0.01 * THETA) ** 2)
    covariance[2, 2] = np.inf
    pooled = pool([Posterior(THETA, covariance)] * 2)
    assert np.isnan(pooled.theta[2])
    assert np.isinf(pooled.std[2])


def test_distances_between_estimates_are_chi_square_distributed() -> None:
    rng = np.random.default_rng(6)
    pairs = [disagreement(random_posterior(rng).shared, random_posterior(rng).shared) for _ in range(800)]
    assert {dof for _, dof in pairs} == {6}
    assert np.mean([d for d, _ in pairs]) == pytest.approx(6.0, rel=0.08)
    groups = [pooled([random_posterior(rng) for _ in range(4)]) for _ in range(400)]
    assert {group.dof for group in groups} == {18}
    assert np.mean([group.inconsistency for group in groups]) == pytest.approx(18.0, rel=0.05)


def test_estimates_at_different_speeds_are_brought_to_their_mean_speed() -> None:
    # An aircraft at 20 and 30 m/s: forces with V, moments with V², gravity's g/V in Z_0.
    lift_part, at_25 = -0.4, {}
    for v in (20.0, 25.0, 30.0):
        s = v / 25.0
        at_25[v] = np.array(
            [
                lift_part * s + 9.80665 / v,
                -1.0 * s,
                0.1,
                0.5 * s,
                0.4 * s**2,
                -5.0 * s**2,
                -2.0 * s,
                -7.0 * s**2,
            ]
        )
    both = [estimate(at_25[v], airspeed_m_s=v) for v in (20.0, 30.0)]
    for posterior in posteriors_at_one_speed(both):
        np.testing.assert_allclose(posterior.theta, at_25[25.0], rtol=1e-12)


def test_the_colour_of_the_residuals_is_shared_by_the_manoeuvres() -> None:
    # One manoeuvre's own colour came out six times too small, by chance: the others correct it.
    white = estimate().covariance_cr
    colours = [1.0, 6.0, 6.5, 5.5, 6.0]
    coloured = [replace(estimate(), covariance=k**2 * white) for k in colours]
    for posterior in posteriors_at_one_speed(coloured):
        np.testing.assert_allclose(posterior.covariance, 36.0 * white)


def test_without_every_air_speed_nothing_is_scaled() -> None:
    mixed = [estimate(airspeed_m_s=20.0), estimate(airspeed_m_s=None)]
    assert all(np.array_equal(b.theta, THETA) for b in posteriors_at_one_speed(mixed))


def test_the_order_of_parameters_is_that_of_the_house() -> None:
    assert [PARAMETERS[k] for k in INTERCEPTS] == ["Z_0", "M_0"]


def partly_known(rng: np.random.Generator) -> list[Posterior]:
    """Five posteriors: one derivative that a single one alone knows, another that one does not know."""
    posteriors = [random_posterior(rng) for _ in range(5)]
    for posterior, k in [*((posterior, 2) for posterior in posteriors[1:]), (posteriors[3], 6)]:
        posterior.covariance[k, :] = posterior.covariance[:, k] = 0.0
        posterior.covariance[k, k] = np.inf
    return posteriors


def test_inconsistency_is_chi_square_about_the_pooled_value() -> None:
    posteriors = partly_known(np.random.default_rng(6))
    whole = pooled(posteriors)
    direct = 0.0
    for posterior in posteriors:
        apart = posterior.shared.theta - whole.shared.theta
        direct += float(apart @ posterior.information @ apart)
    assert whole.inconsistency == pytest.approx(direct)
    assert whole.dof == 5 * 6 - 4 - 1 - 6


def assert_alike(one: Pooled, other: Pooled) -> None:
    np.testing.assert_allclose(one.shared.theta, other.shared.theta)
    np.testing.assert_allclose(one.shared.covariance, other.shared.covariance)
    assert (one.inconsistency, one.dof) == pytest.approx((other.inconsistency, other.dof))


def test_leaving_out_each_in_turn_equals_pooling_the_others() -> None:
    posteriors = partly_known(np.random.default_rng(6))
    for k, others in enumerate(pooled_without_each(posteriors)):
        assert_alike(others, pooled([b for i, b in enumerate(posteriors) if i != k]))


def test_both_sides_of_every_split_equal_pooling_each_side() -> None:
    posteriors = partly_known(np.random.default_rng(7))
    for k, (before, after) in enumerate(pooled_on_both_sides(posteriors), start=1):
        assert_alike(before, pooled(posteriors[:k]))
        assert_alike(after, pooled(posteriors[k:]))


def test_pooling_averages_out_each_estimate_s_own_error_and_not_the_one_that_all_share() -> None:
    own, common = np.diag((0.02 * THETA) ** 2), np.diag((0.01 * THETA) ** 2)
    four = [replace(estimate(covariance=own + common), common=common)] * 4
    pooled = pool(posteriors_at_one_speed(four))
    np.testing.assert_allclose(np.diag(pooled.covariance), np.diag(own) / 4.0, rtol=1e-6)
    np.testing.assert_allclose(pooled.std**2, np.diag(own) / 4.0 + np.diag(common), rtol=1e-6)


def test_a_rudder_test_in_gusts_keeps_its_own_colour_among_calm_tests_of_the_aileron() -> None:
    calm, gusty = side_estimate("aileron"), side_estimate("rudder")
    gusty = replace(gusty, covariance=36.0 * gusty.covariance_cr)
    *_, last = posteriors_at_one_speed([calm, calm, gusty])
    known = np.isfinite(last.std)
    assert last.std[known] == pytest.approx(6.0 * gusty.std_cr[known])


def test_a_derivative_by_a_control_that_does_not_move_is_no_evidence() -> None:
    aileron, rudder = posteriors_at_one_speed([side_estimate("aileron"), side_estimate("rudder")])
    unknown = {name for name, std in zip(aileron.names, aileron.std, strict=True) if not np.isfinite(std)}
    assert unknown == {"Y_delta_r", "L_delta_r", "N_delta_r"}
    pooled_of_both = pool([aileron, rudder])
    k = aileron.names.index("N_delta_r")
    assert pooled_of_both.theta[k] == pytest.approx(rudder.theta[k])


PLAN = CampaignPlan()


def odd(*thetas, plan=PLAN, std_percent=0.1):
    return list(
        outliers(posteriors_at_one_speed([estimate(t, std_percent=std_percent) for t in thetas]), plan)
    )


WIDE = replace(PLAN, tolerance={"M_alpha": 0.2 * 4.93})
STRICT = replace(PLAN, tolerance_percent=2.0)


@row("a difference within the tolerance is no outlier", "M_alpha", 1.08, PLAN, [])
@row("a difference in size is an outlier", "M_alpha", 1.15, PLAN, [3])
@row("a difference within a wider tolerance is no outlier", "M_alpha", 1.15, WIDE, [])
@row("a difference beyond a stricter tolerance is an outlier", "M_alpha", 1.08, STRICT, [3])
@row("a derivative that the crew does not judge is no outlier", "Z_q", 3.0, PLAN, [])
def test_a_manoeuvre_that_differs_from_three_others_is_an_outlier(name, factor, plan, found):
    assert odd(THETA, THETA, THETA, with_change(name, factor), plan=plan) == found


@pytest.mark.parametrize("scatter", [6.0, 10.0])
def test_others_that_scatter_beyond_their_stated_errors_are_the_scale_of_the_distance(scatter):
    rng = np.random.default_rng(5)
    others = [drawn(rng, std_percent=scatter).theta for _ in range(3)]
    assert odd(*others, with_change("M_alpha", 1.3)) == []


def test_chance_makes_an_outlier_of_one_manoeuvre_in_a_thousand_at_most_one_campaign_in_a_hundred():
    rng = np.random.default_rng(11)
    campaigns = [posteriors_at_one_speed([drawn(rng, std_percent=6.0) for _ in range(5)]) for _ in range(200)]
    assert sum(bool(outliers(one, PLAN)) for one in campaigns) <= 2


def test_an_aileron_test_does_not_contradict_a_rudder_test_about_the_rudder():
    aileron, rudder = side_estimate("aileron", percent=1.0), side_estimate("rudder", percent=1.0)
    # A control at rest leaves its derivatives at the prior's mean, with hardly an error.
    still = [aileron.names.index(name) for name in ("Y_delta_r", "L_delta_r", "N_delta_r")]
    theta, covariance = aileron.theta.copy(), aileron.covariance.copy()
    theta[still], covariance[still, still] = 0.0, 1e-10
    aileron = replace(aileron, theta=theta, covariance=covariance, covariance_cr=covariance)
    plan = replace(PLAN, parameters=("L_p", "N_delta_r"))
    assert outliers(posteriors_at_one_speed([aileron, aileron, rudder, aileron]), plan) == {}
