"""The search for a simple law outside the catalogue that explains more than all named effects.

Two or three effects together imitate such a law well. A single law that explains more than all of them is
likelier.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import CERTAIN, LEAST_GAIN
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.fitting.uncertainty import effective_samples, log_prior_of
from advisor.gap.kit.variant import Variant
from advisor.gap.search.acceptance import JudgedAddition
from advisor.gap.search.score import (
    addition,
    log_likelihood_gained,
    log_odds_in,
    price_of,
    price_of_edges,
)
from advisor.gap.search.screen import Screen, penalty
from advisor.gap.search.stage import Stage, added_in
from advisor.gap.uncatalogued.candidate_laws import MUST_LEAVE_LITTLE, RINGING, laws_for, sentence_of
from advisor.gap.uncatalogued.unexplained import Unexplained

_FITTED_SHARE = 0.2
"""Numerical: least share of the likeliest law's gain in the screening for a full fit of another."""
_OUT_OF_REACH = 200.0
"""Numerical: cost above that of the best law, or of all effects together, at which the fit of a law is given
up."""
_LEAVES = 0.3
"""Largest residual share of some channel's power for a law of ``MUST_LEAVE_LITTLE``. A tilted attitude
resembles a gyro that is sensitive to acceleration, and a vibrating propeller resembles a surface stop."""
_MISSING = 0.03
"""Numerical: residual of all effects beyond noise, as a share of some channel's peak, above which a ringing
servo is tried from every start."""


@dataclass(frozen=True)
class Law:
    """A law that was found, with its fit."""

    unexplained: Unexplained
    fitted: EffectFit
    """The baseline model with the law."""


@dataclass(frozen=True)
class LawSearch:
    """The result of a search for a law, whether or not one explains more than all named effects."""

    law: Law | None
    gains: Mapping[str, float]
    """Gain in log likelihood of the best law of each block, minus the price of its parameters."""


def search_law(problem: EffectProblem, stages: list[Stage]) -> LawSearch:
    """Seek the law that explains more than all named effects."""
    fits = _fits(problem, stages)
    samples = float(np.sum(counts(problem)))
    gains: dict[str, float] = {}
    for law, fitted in fits:
        gain = 0.5 * (stages[0].fitted.cost - fitted.cost - penalty(law, samples))
        gains[law.block] = max(gain, gains.get(law.block, 0.0))
    return LawSearch(_likeliest(problem, stages, fits) if fits else None, gains)


def _likeliest(
    problem: EffectProblem, stages: list[Stage], fits: Sequence[tuple[Variant, EffectFit]]
) -> Law | None:
    """Return the likeliest law if it explains more than all named effects, otherwise None."""
    baseline, held = stages[0].fitted, stages[0].held_out
    samples = float(np.sum(effective_samples(problem, baseline.innovations)))
    law, fitted = min(fits, key=lambda pair: pair[1].cost + penalty(pair[0], samples))
    effective = effective_samples(problem, fitted.innovations)
    judged = addition(problem, baseline, held, fitted, law.effect, effective)
    if not _is_law(problem, stages, judged, effective):
        return None
    block = law.block
    rivals = {j.block: _share(j, judged) for j in reversed(stages[0].considered)}
    ranking = sorted(((b, s) for b, s in rivals.items() if b != block), key=lambda pair: -pair[1])
    share = float(np.clip(1.0 - np.mean(judged.held_out.mean_square / held.mean_square), 0.0, 1.0))
    note = sentence_of(judged.effect, judged.value)
    return Law(Unexplained(block, share, ((block, 1.0), *ranking), note=note), fitted)


def _fits(problem: EffectProblem, stages: list[Stage]) -> list[tuple[Variant, EffectFit]]:
    """Return full fits of the laws that the screening promises, each with its variant."""
    baseline, named_cost = stages[0].fitted, stages[-1].fitted.cost
    found = Screen(problem, baseline).quick_fits(laws_for(problem.flights), baseline.cost - named_cost)
    best = min((s.cost for s in found), default=baseline.cost)
    most = baseline.cost - 2.0 * max(CERTAIN, 0.5 * _FITTED_SHARE * (baseline.cost - best))
    # A law that changes the derivatives takes more steps than a screening makes.
    fits: list[tuple[Variant, EffectFit]] = []
    lost = named_cost + _OUT_OF_REACH
    for s in sorted(found, key=lambda s: s.cost):
        if s.cost <= most:
            fits.append((s.variant, fit(problem, s.point, s.noise, tolerance=0.5, beaten_by=lost)))
            lost = min(lost, fits[-1][1].cost + _OUT_OF_REACH)
    noise = 0.0 if problem.instruments is None else problem.instruments
    missing = np.sqrt(np.maximum(stages[-1].held_out.mean_square - noise**2, 0.0))
    if np.any(missing > _MISSING * problem.flights.peaks):
        # No small change leads to a servo that rings all along: the search begins at every frequency.
        points = [baseline.point.with_effect(RINGING, start) for start in RINGING.starts]
        fits += [(RINGING, fit(problem, p, baseline.noise, tolerance=0.5, beaten_by=lost)) for p in points]
    return fits


def _is_law(
    problem: EffectProblem, stages: list[Stage], judged: JudgedAddition, effective: FloatArray
) -> bool:
    """Return whether a law explains more than all named effects, and is not one of them in disguise."""
    held, disputed = stages[0].held_out, stages[-1].disputed
    # Effective sample sizes depend on the fit that gives them: both gains are computed with the same ones.
    # An effect of the catalogue that is too small to be named is no law either.
    small = max((one.gain for one in stages[0].considered if one.is_only_small), default=0.0)
    named = max(_gain_of_all(problem, stages, effective), 0.0 if disputed is None else disputed.gain, small)
    if not judged.is_accepted or judged.gain < max(CERTAIN, named + LEAST_GAIN):
        return False
    after, before = (np.sum(h.by_maneuver / held.mean_square, axis=1) for h in (judged.held_out, held))
    if 2 * np.count_nonzero(after < before) <= len(before):
        # An improvement in the smaller part of the manoeuvres is a gust, or a fault that comes and goes.
        return False
    remaining_shares = judged.held_out.mean_square / held.mean_square
    return judged.effect not in MUST_LEAVE_LITTLE or bool(np.min(remaining_shares) <= _LEAVES)


def _gain_of_all(problem: EffectProblem, stages: list[Stage], effective: FloatArray) -> float:
    """Return the gain of all effects together, by the definition of ``Judged.gain``; 0 without any."""
    first, last = stages[0], stages[-1]
    named = added_in(stages)
    if not named:
        return 0.0
    likelihood = log_likelihood_gained(first.fitted, first.held_out, last.fitted, last.held_out, effective)
    likelihood += 0.5 * (problem.nuisance_cost(first.fitted.point) - problem.nuisance_cost(last.fitted.point))
    likelihood += 0.5 * (price_of_edges(problem, first.fitted) - price_of_edges(problem, last.fitted))
    prior_gain = log_prior_of(problem, last.fitted, effective) - log_prior_of(
        problem, first.fitted, effective
    )
    price = sum(price_of(j.variant, effective) for j in named)
    odds = sum(log_odds_in(problem, j.effect, float(j.value[0])) for j in named)
    return likelihood + prior_gain + odds - price


def _share(judged: JudgedAddition, best: JudgedAddition) -> float:
    """Return the gain relative to the best one, 0 to 1."""
    return round(float(np.clip(judged.gain / best.gain, 0.0, 1.0)), 4)
