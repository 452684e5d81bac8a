"""Names found one after the other, where others would have been better from the first.

A single effect fitted to the sum of two may be neither.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.candidates.traits import BY_NATURE
from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.problem import Problem
from advisor.gap.search.merit import CERTAIN, LEAST_SIGMA
from advisor.gap.search.ranking import candidates_for, judge
from advisor.gap.search.stage import Stage, added_in, is_likelier, only, rebuilt, replaced_by

_CLEARLY = 20.0
"""Cost by which a pair of names must beat those that were found first."""
_TRIED = 3
"""How many likenesses of what is certain, and companions of each, are tried."""
_PROMISING = 0.5
"""Share of what the first effect brings that the screening must promise of another companion."""
_BESIDE = 2
"""Names from which on one of them stands beside another."""
_SEVERAL = 2
"""Streams that are late, from which on the command may be, and another stream early."""


def one_for_another(problem: Problem, stages: list[Stage], _: Sequence[Variant]) -> list[Stage]:
    """What is likeliest beside the names, and takes the place of one of them: together neither can be told.

    Late by a filter and late by its stamps an angle of attack is much the same, and what was found first
    keeps the other out.
    """
    last = stages[-1].fitted
    names = [j.effect for j in added_in(stages)]
    for n, stage in enumerate(stages[1:], start=1):
        rival = next(iter(stage.considered), None)
        if rival is None or rival.sigmas > LEAST_SIGMA or rival.gain < CERTAIN:
            continue
        others = [[name for name in names[:n] if name != left_out] for left_out in names[:n]]
        fits = [only(problem, rival.fitted, [*kept, rival.effect]) for kept in others]
        best = min(fits, key=lambda f: f.cost)
        if is_likelier(problem, best, last):
            return replaced_by(problem, stages[0], best)
    return stages


def two_in_place_of_one(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """Two effects, each worth a name, for one that leaves something certain which is too small for a name.

    What imitates the sum of two is not quite their sum: a late vane that reads low looks like one far ahead
    of the centre of gravity, but for a rest that no noise leaves. A rest of what every aircraft has to some
    degree is no sign of that.
    """
    first = stages[0].added
    if first is None or len(stages) != 2:
        return stages
    certain = [j for j in stages[1].considered if j.gain >= CERTAIN and j.effect not in BY_NATURE]
    best, least = None, min((j.fitted.cost for j in certain), default=first.fitted.cost)
    for rest in certain[:_TRIED]:
        alone = only(problem, rest.fitted, [rest.effect])
        others = candidates_for(problem, alone, [v for v in variants if v.effect != first.effect])
        near = [c for c in others[:_TRIED] if c.cost < least + _PROMISING * (alone.cost - least)]
        for companion in judge(problem, alone, hold_out(problem, alone), near):
            if companion.worth_naming and companion.fitted.cost < least:
                best, least = companion.fitted, companion.fitted.cost
    return stages if best is None else replaced_by(problem, stages[0], best)


def other_description(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """Another description of a name, which was judged when those after it were not yet in the model."""
    names = [j.effect for j in added_in(stages)]
    if len(names) < _BESIDE:
        return stages
    best = stages[-1].fitted
    for name in names:
        point = best.point
        k = point.index_of(name)
        for form in _forms_beside(point.effects[k], variants):
            values = point.values[k] if form.carried is None else np.array(form.carried(point.values[k]))
            there = replace(
                point,
                effects=(*point.effects[:k], form, *point.effects[k + 1 :]),
                values=(*point.values[:k], values, *point.values[k + 1 :]),
            )
            otherwise = fit(problem, there, best.noise, tolerance=0.5, beaten_by=best.cost)
            if is_likelier(problem, otherwise, best):
                best = otherwise
    if best is stages[-1].fitted:
        return stages
    considered = {s.added.effect: s.considered for s in stages if s.added is not None}
    return rebuilt(problem, stages[0], names, best, considered, stages[-1].considered)


def _forms_beside(named: Variant, variants: Sequence[Variant]) -> list[Variant]:
    """The other descriptions that have the same numbers, of one that may itself be another's other."""
    families = ((v, *v.likewise) for v in variants if v.effect == named.effect)
    family = next((f for f in families if any(form is named for form in f)), ())
    return [form for form in family if form is not named and form.names == named.names]


def one_early(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """A late command and one stream that is early, where several streams seemed late.

    To the data they are the same but for the command's edges; two causes are likelier than three.
    """
    named = added_in(stages)
    late = {j.effect: float(j.value[0]) for j in named if j.variant.names[0] == "skew_s" and j.value[0] > 0.0}
    delay = next((v for v in variants if v.effect == "transport_delay"), None)
    if len(late) < _SEVERAL or delay is None:
        return stages
    first, last, by_s = stages[0], stages[-1].fitted, max(late.values())
    early = [v for v in variants if v.names[0] == "skew_s" and v.effect not in late and not v.fixed]
    pairs: list[Fitted] = []
    for skew in early:
        point = first.fitted.point.with_effect(delay, (by_s,)).with_effect(skew, (-by_s,))
        pairs.append(fit(problem, point, last.noise, tolerance=0.5, beaten_by=last.cost))
    best = min(pairs, key=lambda f: f.cost, default=last)
    if best.cost > last.cost - _CLEARLY:
        return stages
    return replaced_by(problem, first, best)


def one_number_for_ice(problem: Problem, stages: list[Stage], variants: Sequence[Variant]) -> list[Stage]:
    """More mass, or another centre of gravity, in the place of ice that was named beside something else.

    Ice weakens four derivatives, each by its own share. What was not yet in the model when it was named had
    its part in them; beside it one number may do as well, and is likelier then.
    """
    names = [j.effect for j in added_in(stages)]
    if "icing" not in names or len(names) < _BESIDE:
        return stages
    last = stages[-1].fitted
    k = next(i for i, effect in enumerate(last.point.effects) if effect.effect == "icing")
    ice, values = last.point.effects[k], last.point.values[k]
    beside = last.point.with_only([e.effect for e in last.point.effects if e.effect != "icing"])
    weaker, when, step_s = float(np.mean(values[:4])), values[4:], ice.fixed.get("at_s")
    starts = {"mass_change": -weaker / (1.0 + weaker), "cg_shift": float(values[ice.names.index("M_alpha")])}
    others = [v for v in variants if v.effect in starts and v.effect not in names]
    forms = [form for v in others for form in (v, *v.likewise)]
    at_once = [f for f in forms if len(f.names) == 1 + len(when) and f.fixed.get("at_s") == step_s]
    points = [
        beside.with_effect(form, (float(np.clip(starts[form.effect], *form.bounds[0])), *when))
        for form in at_once
    ]
    fits = [fit(problem, point, last.noise, tolerance=0.5) for point in points]
    best = min(fits, key=lambda f: f.cost, default=last)
    return replaced_by(problem, stages[0], best) if is_likelier(problem, best, last) else stages
