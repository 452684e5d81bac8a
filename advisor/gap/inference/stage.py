"""One stage: every explanation that may be added to a model, fitted and weighed by its evidence."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.evidence import FlightProblem, temperature
from advisor.gap.inference.explanation import Explanation, change_of, explained
from advisor.gap.inference.model_error import most_nats
from advisor.gap.kit.variant import Variant
from advisor.gap.search.screen import Screen, Screened

_EFFECTS, _LAWS = 6, 2
"""Numerical: number of effects, and of laws outside the catalogue, that are fitted in full."""
_AT_THE_FILE = 3
"""Numerical: number of effects that are fitted in full because they are the likeliest with the file's
derivatives. A wrong derivative hides such an effect from the fit in which all are free."""
_FORMS = 2
"""Numerical: number of descriptions of one effect that are fitted in full."""
_REFINED = 120.0
"""Numerical: nats behind the best explanation beyond which none is fitted at the file's derivatives."""


@dataclass(frozen=True)
class Stage:
    """All explanations of one stage."""

    plain: Explanation
    """Derivatives alone."""
    effects: tuple[Explanation, ...]
    laws: tuple[Explanation, ...]
    """Laws outside the catalogue."""
    heat: float

    @property
    def best(self) -> Explanation:
        """The explanation with the largest evidence."""
        return max((self.plain, *self.effects, *self.laws), key=lambda one: one.evidence.either)


def stage_of(
    problem: FlightProblem,
    plain: EffectFit,
    table: Sequence[Variant],
    laws: Sequence[Variant],
    most: int = _EFFECTS,
    error: float = 0.0,
) -> Stage:
    """Fit all that may be added to the model of ``plain``, and return it with its evidence.

    Parameters
    ----------
    table, laws
        Effects of the catalogue, and laws outside of it, with a prior on each number.
    most
        Number of effects that are fitted in full.
    error
        Error of the form of the effects in ``plain``, as a share of the peaks.
    """
    loose = problem.within(ERROR_IF_WRONG)
    plain = fit(loose, plain.point, plain.noise, iterations=4)
    screen = Screen(loose, plain)
    chosen = [*_likeliest(screen.quick_fits(table), most), *_likeliest(screen.quick_fits(laws), _LAWS)]
    if problem.is_stated:
        seen = {one.variant.effect for one in chosen}
        near = problem.within(ERROR_IF_RIGHT)
        tight = Screen(near, fit(near, plain.point, plain.noise, iterations=4))
        others = [variant for variant in table if variant.effect not in seen]
        chosen += _likeliest(tight.quick_fits(others), _AT_THE_FILE)
    fits = [(one.variant, fit(loose, one.point, one.noise, iterations=8)) for one in chosen]
    fits = [(variant, made) for variant, made in fits if np.isfinite(made.cost)]
    heat = temperature(problem, min((plain, *(made for _, made in fits)), key=lambda made: made.cost))
    everyone = [explained(loose, None, plain, plain, heat)]
    everyone += [explained(loose, variant, made, plain, heat) for variant, made in fits]
    best = max(one.evidence.either for one in everyone)
    everyone = [_at_the_files(one, plain, heat, best) for one in everyone]
    base, *added = _within_model_error(problem, everyone, error)
    outside = {law.effect for law in laws}
    return Stage(
        base,
        tuple(one for one in added if one.name not in outside),
        tuple(one for one in added if one.name in outside),
        heat,
    )


def _likeliest(screened: Sequence[Screened], most: int) -> Iterator[Screened]:
    """Yield the quick fits of the likeliest effects, at most ``_FORMS`` of each."""
    kept: dict[str, list[Screened]] = {}
    for one in sorted(screened, key=lambda s: s.cost + 2.0 * len(s.variant.names)):
        if one.variant.effect in kept or len(kept) < most:
            kept.setdefault(one.variant.effect, []).append(one)
    for forms in kept.values():
        yield from forms[:_FORMS]


def _at_the_files(one: Explanation, plain: EffectFit, heat: float, best: float) -> Explanation:
    """Return an explanation fitted again where the file's derivatives are right, if that is likelier.

    The quadratic expansion about fitted derivatives does not reach far.
    """
    if not one.problem.is_stated or max(one.evidence.wrong, one.evidence.right) < best - _REFINED:
        return one
    near = one.problem.within(ERROR_IF_RIGHT)
    made = fit(near, one.fitted.point, one.fitted.noise, iterations=5)
    if not np.isfinite(made.cost):
        return one
    right = explained(near, one.variant, made, plain, heat)
    told = right.evidence.right if one.variant else max(right.evidence.right, one.evidence.right)
    kept = right if told > one.evidence.wrong else one
    natural = max(right.natural.right, one.natural.right)
    return replace(
        kept,
        evidence=replace(one.evidence, right=told),
        natural=replace(one.natural, right=natural),
    )


def _within_model_error(
    problem: EffectProblem, everyone: Sequence[Explanation], error: float
) -> list[Explanation]:
    """Return all explanations, none of whose likelihoods is less than the error of a simulator allows.

    Residuals cannot distinguish two models whose outputs differ by less than such an error. More samples do
    not help. The prior still does.
    """
    best = max(everyone, key=lambda one: one.likelihood)

    def lifted(one: Explanation) -> Explanation:
        apart = change_of(problem, one.fitted, best.fitted)
        least = best.likelihood - most_nats(apart, error, best.form_error)
        return one.lifted(max(0.0, least - one.likelihood))

    return [one if one is best else lifted(one) for one in everyone]
