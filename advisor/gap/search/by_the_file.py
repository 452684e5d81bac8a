"""Names with the aircraft file's own derivatives, where those that were found need other ones."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import belief_in, worth
from advisor.gap.search.merit import LEAST_BELIEF, LEAST_GAIN, MOST_EFFECTS
from advisor.gap.search.screen import Screen
from advisor.gap.search.stage import Stage, added_in, price_of_all, replaced_by

_CLEARLY = 20.0
"""Cost by which another name must make the model better."""
_WORTH_A_FIT = 2
"""Likeliest candidates that are fitted where the derivatives are held at the file's."""


def by_the_file(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """Other names that explain as much with the file's own derivatives, where those found need other ones.

    Two effects may look like one effect and wrong numbers. Held at the file's numbers, each shows as it is.
    """
    names, last = len(added_in(stages)), stages[-1].fitted
    if not names or problem.believed is None:
        return stages
    independent = worth(problem, last.innovations)
    as_filed = replace(last, point=replace(last.point, derivatives=problem.believed))
    believed = belief_in(problem, last, independent)
    if belief_in(problem, as_filed, independent) - believed < LEAST_BELIEF:
        return stages
    most = max(names, min(names + 1, MOST_EFFECTS))
    found = _held_at_the_file(replace(problem, holds_the_file=True), stages[0].fitted, variants, most)
    others = fit(problem, found.point, found.noise, tolerance=0.5, beaten_by=last.cost + 2.0 * LEAST_GAIN)
    gained = belief_in(problem, others, independent) - believed + 0.5 * (last.cost - others.cost)
    priced = price_of_all(others, independent) - price_of_all(last, independent)
    if gained - priced < LEAST_GAIN:
        return stages
    again = replaced_by(problem, stages[0], others)
    # One of them alone may throw the model far off: then the names do not stand one after the other.
    falls = all(after.fitted.cost < before.fitted.cost for before, after in pairwise(again))
    # Of several, those that the whole does not miss are dropped later; a single one must stand by itself.
    named = added_in(again)
    stands = len(named) > 1 or any(judged.worth_naming for judged in named)
    return again if falls and stands else stages


def _held_at_the_file(held: Problem, plain: Fitted, variants: Sequence[Variant], names: int) -> Fitted:
    """The model built up by so many names at most, the derivatives held."""
    assert held.believed is not None
    model = fit(held, replace(plain.point, derivatives=held.believed), plain.noise, tolerance=0.5)
    for _ in range(names):
        present = {effect.effect for effect in model.point.effects}
        others = [v for v in variants if v.effect not in present]
        likeliest = Screen(held, model).try_all(others, lambda _: 0.0)[:_WORTH_A_FIT]
        fits = [fit(held, s.point, s.noise, tolerance=0.5) for s in likeliest]
        best = min(fits, key=lambda f: f.cost, default=model)
        if best.cost > model.cost - _CLEARLY:
            break
        model = best
    return model
