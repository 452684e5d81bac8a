"""What is likeliest beside a name and cannot be told from it takes its place."""

from dataclasses import replace

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.companions import one_for_another
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage
from tests.gap.generator import LIGHT_AIRCRAFT, Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

SKEW_S, ARM_M = 0.08, 2.4


@pytest.fixture(scope="module")
def stages():
    """A vane ahead of the centre of gravity with late stamps, taken for a lag and then seen as it is."""
    late = Setup(
        maneuvers=5, skew={"alpha": SKEW_S}, switches={"vane_arm": ARM_M}, airframe=LIGHT_AIRCRAFT, seed=21
    )
    problem, plain = fit_baseline(prepare(fly(late), Aircraft()), Aircraft())
    lag, arm, skew = (
        next(v for v in variants_for(problem.flights) if v.effect == effect)
        for effect in ("alpha_lag", "alpha_vane_offset", "alpha_skew")
    )
    lagging = fit(problem, plain.point.with_effect(lag, (0.05,)), plain.noise)
    ahead = fit(problem, lagging.point.with_effect(arm, (3.0,)), lagging.noise)
    replaced = fit(
        problem,
        plain.point.with_effect(lag, (0.0,)).with_effect(arm, (ARM_M,)).with_effect(skew, (SKEW_S,)),
        ahead.noise,
    )
    fits = (plain, lagging, ahead, replaced)
    added = [
        addition(
            problem, one, hold_out(problem, one), other, effect.effect, worth(problem, other.innovations)
        )
        for one, other, effect in zip(fits[:-1], fits[1:], (lag, arm, skew), strict=True)
    ]
    named = [
        Stage(f, hold_out(problem, f), (j,), j) for f, j in zip((plain, lagging), added[:2], strict=True)
    ]
    return problem, [*named, Stage(ahead, hold_out(problem, ahead), (added[2],), None)]


def names_after(problem, named, sigmas):
    """The names and their sizes, the rival of the last stage known so well beside them."""
    *before, last = named
    rival = replace(last.considered[0], sigmas=sigmas)
    again = one_for_another(problem, [*before, replace(last, considered=(rival,))], [])
    whole = again[-1].fitted.point
    sizes = {v.effect: float(x[0]) for v, x in zip(whole.effects, whole.values, strict=True) if not v.always}
    assert sizes.keys() == {s.added.effect for s in again if s.added is not None}
    return sizes


def test_a_name_gives_way_to_what_explains_more_and_is_not_known_beside_it(stages):
    assert names_after(*stages, sigmas=2.0) == {
        "alpha_vane_offset": pytest.approx(ARM_M, rel=0.05), "alpha_skew": pytest.approx(SKEW_S, abs=0.003),
    }  # fmt: skip


def test_what_is_known_beside_a_name_takes_nothings_place(stages):
    assert names_after(*stages, sigmas=30.0).keys() == {"alpha_lag", "alpha_vane_offset"}
