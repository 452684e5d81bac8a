"""The waterfall: effects are added one by one until no other helps on held-out manoeuvres."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from advisor.gap.decision import BEYOND_DOUBT, LEAST_GAIN
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import hold_out, measured_in
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import effective_samples, shared_std
from advisor.gap.kit.variant import Variant
from advisor.gap.search.acceptance import MOST_EFFECTS, JudgedAddition
from advisor.gap.search.ranking import candidates_for, judge
from advisor.gap.search.score import addition
from advisor.gap.search.screen import one_each
from advisor.gap.search.stage import Stage, added_in, fit_with_effects, rebuilt

Progress = Callable[[str, float], None]
"""Function that receives a sentence about the work and the share done, 0 to 1."""


def one_after_another(
    problem: EffectProblem,
    baseline: EffectFit,
    variants: Sequence[Variant],
    progress: Progress = lambda *_: None,
) -> list[Stage]:
    """Return the stages from the baseline model to the last addition; the last stage adds nothing."""
    stages: list[Stage] = []
    fitted, held, ahead = baseline, hold_out(problem, baseline), None
    for n in range(MOST_EFFECTS + 1):
        progress(f"trying {len(variants)} ways to explain the residual", 0.2 + 0.15 * n)
        if n == MOST_EFFECTS:
            stages.append(Stage(fitted, held, (), None))
            break
        screened = [] if ahead else candidates_for(problem, fitted, variants)
        considered = ahead or judge(problem, fitted, held, screened)
        added, ahead = next((j for j in considered if j.is_accepted), None), None
        if added is None and n < MOST_EFFECTS - 1:
            added, ahead = _leading_on(problem, considered, variants)
        stages.append(Stage(fitted, held, tuple(considered), added, () if n else one_each(screened)))
        if added is None:
            break
        fitted, held = added.fitted, added.held_out
    return stages


def _leading_on(
    problem: EffectProblem, considered: Sequence[JudgedAddition], variants: Sequence[Variant]
) -> tuple[JudgedAddition | None, list[JudgedAddition] | None]:
    """Return a certain effect that is too small to be named, where it reveals another effect.

    Two effects may hide each other, because derivatives compensate for one of them. The candidates for the
    next addition are returned too. ``settled`` drops each of the effects that proves needless after the last
    addition.
    """
    if not considered or considered[0].gain < BEYOND_DOUBT:
        return None, None
    first = considered[0]
    screened = candidates_for(problem, first.fitted, variants)
    with_it = judge(problem, first.fitted, first.held_out, screened)
    return (first, with_it) if any(j.is_accepted for j in with_it) else (None, None)


def as_measured(problem: EffectProblem, stages: Sequence[Stage]) -> list[Stage]:
    """Return the stages with the residuals of the fit in manoeuvres that alone determine an effect."""
    sole_maneuvers: set[int] = set()
    measured = []
    for stage in stages:
        held = stage.held_out
        if sole_maneuvers:
            held = measured_in(problem, held, stage.fitted, sole_maneuvers)
        measured.append(replace(stage, held_out=held))
        if stage.added is not None and stage.added.sole_maneuver is not None:
            sole_maneuvers.add(stage.added.sole_maneuver)
    return measured


def in_full(problem: EffectProblem, stages: list[Stage]) -> list[Stage]:
    """Return the stages with sizes from the last model. In earlier models an effect also represented
    others."""
    full = stages[-1].fitted
    if len(added_in(stages)) < 2:
        return stages
    effective = effective_samples(problem, full.innovations)

    def restated(added: JudgedAddition) -> JudgedAddition:
        point = full.point
        k = point.index_of(added.effect)
        std = shared_std(problem, full, effective, trusted=added.prior_gain >= LEAST_GAIN)[point.place(k)]
        return replace(added, variant=point.effects[k], value=point.values[k], std=std)

    return [s if s.added is None else replace(s, added=restated(s.added)) for s in stages]


def settled(problem: EffectProblem, stages: list[Stage]) -> list[Stage]:
    """Return the stages in the order of the loss without each effect. Effects without a loss are dropped.

    The first addition had to explain everything alone, and may be a poor likeness of effects found after it.
    """
    considered = {s.added.effect: s.considered for s in stages if s.added is not None}
    full = stages[-1].fitted
    names = list(considered)
    while len(names) > 1:
        effective = effective_samples(problem, full.innovations)
        without = {name: fit_with_effects(problem, full, [n for n in names if n != name]) for name in names}
        lost_without = {
            name: addition(problem, fewer, hold_out(problem, fewer), full, name, effective)
            for name, fewer in without.items()
        }
        # An effect that held-out manoeuvres do not support goes first, whatever its gain.
        weakest = min(names, key=lambda name: (lost_without[name].is_supported, lost_without[name].gain))
        if lost_without[weakest].is_accepted:
            names.sort(key=lambda name: -lost_without[name].gain)
            break
        names.remove(weakest)
        full = without[weakest]
    if names == [j.effect for j in added_in(stages)]:
        return stages
    if len(names) == 1 and not _stands_alone(problem, stages[0], full, names[0]):
        return [replace(stages[0], added=None)]
    return rebuilt(problem, stages[0], names, full, considered, stages[-1].considered)


def _stands_alone(problem: EffectProblem, first: Stage, full: EffectFit, name: str) -> bool:
    """Return whether the only remaining effect is accepted alone; it may have led to one that was dropped."""
    effective = effective_samples(problem, full.innovations)
    return addition(problem, first.fitted, first.held_out, full, name, effective).is_accepted


def reduced_to(problem: EffectProblem, stages: Sequence[Stage], names: Sequence[str]) -> list[Stage]:
    """Return the waterfall with some of its effects, in their order."""
    considered = {s.added.effect: s.considered for s in stages if s.added is not None}
    if list(names) == list(considered):
        return list(stages)
    if not names:
        return [replace(stages[0], added=None)]
    full = fit_with_effects(problem, stages[-1].fitted, names)
    return in_full(problem, rebuilt(problem, stages[0], names, full, considered, stages[-1].considered))
