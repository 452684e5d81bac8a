"""The ranking of effects: all are screened, the promising ones are fitted fully, and the best judgement comes
first."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.decision import LEAST_GAIN
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.prior import log_prior
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, counts
from advisor.gap.fitting.uncertainty import covariance, effective_samples, log_prior_of
from advisor.gap.kit.variant import Variant
from advisor.gap.search.acceptance import JudgedAddition, size_of
from advisor.gap.search.score import addition, is_baseline, smallest_of
from advisor.gap.search.screen import Screen, Screened, likeliest_first
from advisor.gap.simulator.layout import DERIVATIVES

_PROMISE = 0.7
"""Numerical: share of the least gain that the screening must promise before a full fit."""
_ITERATIONS = 8
_TO_THE_END = 25
"""Numerical: most iterations of the best candidate's fit; other candidates get ``_ITERATIONS``."""
_FITS = 5
"""Numerical: most candidates with a full fit after the screening."""
_RIVAL = 0.3
"""Numerical: least promise of a candidate for a full fit, as a share of the best promise."""
_LACKING = 0.2
"""Numerical: share of the best decrease of the cost that a candidate may lack and still be fitted to the
end."""
_GROSS = 300.0
"""Numerical: promised log likelihood above which the right model is far from the range of the screening."""
_GROSS_FITS = 8
_GROSS_RIVAL = 0.05
"""Numerical: most full fits in that case, and the least share of the best promise that earns one."""


def candidates_for(problem: EffectProblem, fitted: EffectFit, variants: Sequence[Variant]) -> list[Screened]:
    """Return the screened effects that the model does not have yet."""
    present = {e.effect for e in fitted.point.effects}
    effective = counts(problem)
    known = covariance(problem, fitted, effective)[: len(DERIVATIVES), : len(DERIVATIVES)]
    baseline = log_prior_of(problem, fitted, effective)

    def prior_gain(point: SearchPoint) -> float:
        if problem.prior_derivatives is None:
            return 0.0
        return log_prior(point.derivatives, known, problem.prior_derivatives) - baseline

    others = [v for v in variants if v.effect not in present]
    found = Screen(problem, fitted).try_all(others, prior_gain)
    hidden = _from_the_prior(problem, fitted, others, prior_gain)
    return likeliest_first([*found, *hidden], float(np.sum(effective))) if hidden else found


def _from_the_prior(
    problem: EffectProblem,
    baseline: EffectFit,
    variants: Sequence[Variant],
    prior_gain: Callable[[SearchPoint], float],
) -> list[Screened]:
    """Return fits of hidden effects from the aircraft file's derivatives; none where the fitted ones are near
    these.

    A wing that is stalled throughout has another lift slope, and hardly any other symptom.
    """
    if problem.prior_derivatives is None or not is_baseline(baseline):
        return []
    file = replace(baseline.point, derivatives=problem.prior_derivatives)
    if prior_gain(file) < LEAST_GAIN:
        return []
    points = [file.with_effect(v, v.start_at_prior) for v in variants if v.start_at_prior is not None]
    fits = [fit(problem, point, baseline.noise, _TO_THE_END, 0.5) for point in points]
    return [Screened(f.point.effects[-1], f.point, f.cost, f.noise, prior_gain(f.point)) for f in fits]


def judge(
    problem: EffectProblem, before: EffectFit, held_before: HeldOut, candidates: Sequence[Screened]
) -> list[JudgedAddition]:
    """Return full fits of the best variants of the best effects, best judgement first."""
    fits: list[EffectFit] = []
    for s in shortlist(problem, before, candidates):
        first_description, *otherwise = (
            fit(problem, point, s.noise, _ITERATIONS, 0.5, beaten_by=_no_rival(before, fits))
            for point in _described(s.point)
        )
        fits += [first_description, *(other for other in otherwise if other.cost < first_description.cost)]
    if not fits:
        return []
    effective = effective_samples(problem, min(fits, key=lambda f: f.cost).innovations)
    judged = [addition(problem, before, held_before, f, f.point.effects[-1].effect, effective) for f in fits]
    best: dict[str, JudgedAddition] = {}
    for one in sorted(judged, key=lambda j: -j.gain):
        best.setdefault(one.effect, one)
    first, *rest = best.values()
    if first.fitted.iterations == _ITERATIONS:
        # Far from the baseline model the search is long, so only the best candidate is fitted to the end.
        ended = fit(problem, first.fitted.point, first.fitted.noise, _TO_THE_END, tolerance=0.5)
        first = addition(problem, before, held_before, ended, first.effect, effective)
    return [first, *rest]


def _no_rival(before: EffectFit, fits: Sequence[EffectFit]) -> float:
    """Return the cost above which a candidate is no rival, wherever its search would end."""
    best = min((before.cost, *(f.cost for f in fits)))
    return best + _LACKING * (before.cost - best)


def _described(point: SearchPoint) -> list[SearchPoint]:
    """Return the point, and those with the alternative descriptions of its last effect."""
    last, values = point.effects[-1], point.values[-1]
    before = replace(point, effects=point.effects[:-1], values=point.values[:-1])
    return [
        point,
        *(
            before.with_effect(other, values if other.carried is None else other.carried(values))
            for other in last.likewise
        ),
    ]


def shortlist(problem: EffectProblem, before: EffectFit, candidates: Sequence[Screened]) -> list[Screened]:
    """Return the candidates for a full fit; ``candidates`` come best first.

    An effect too small to be named is no rival of others. Where the gap is large, order and sizes of the
    screening are less reliable: more effects are fitted then, and two variants of each.
    """

    def promise(c: Screened) -> float:
        return 0.5 * (before.cost - c.cost)

    def best_of(some: Sequence[Screened]) -> float:
        return max((promise(c) + c.prior_gain for c in some), default=0.0)

    gross = best_of(candidates) > _GROSS
    if not gross:
        candidates = [
            c for c in candidates
            if size_of(c.variant, c.point.values[-1]) >= smallest_of(problem, c.variant, promise(c))
        ]  # fmt: skip
    least = (_GROSS_RIVAL if gross else _RIVAL) * best_of(candidates)
    chosen: list[Screened] = []
    for c in candidates:
        promises = max(promise(c), c.prior_gain) >= _PROMISE * LEAST_GAIN
        same = sum(c.variant.effect == other.variant.effect for other in chosen)
        if promises and promise(c) + c.prior_gain >= least and same < (2 if gross else 1):
            chosen.append(c)
    chosen = chosen[: _GROSS_FITS if gross else _FITS]
    # A twin of wrong derivatives is as far from the baseline model as these are. The screening's
    # sensitivities are those of another model and say little about such a fit.
    twins = [c for c in candidates if c.variant.twin is not None and c.prior_gain >= LEAST_GAIN]
    return [*chosen, *(c for c in twins if c not in chosen)]
