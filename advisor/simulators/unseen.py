"""Gap on manoeuvres that no fit has used.

All manoeuvres are used to select the effects. The fits of derivatives and sizes exclude the held-out
manoeuvres. ``advisor gap --prove`` excludes the held-out manoeuvres from the whole search.

A correction that increases this gap is withdrawn. It shortens the improved simulator and changes no
probability, because the posterior gives the answer.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import PROPELLER
from advisor.gap.diagnose import Examined
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import shrink_interval, whole_gap
from advisor.gap.fitting.natural import with_natural
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.fitting.refit import own_refitted
from advisor.gap.result import VISIBLE, Diagnosis, InSimulator, Shrink, spelled
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.verdict.causes import parameters_of
from advisor.gap.verdict.holdout_numbers import over_maneuvers, with_offset
from advisor.gap.verdict.statements import in_simulator
from advisor.gap.verdict.text import answers_of, sentence_of
from advisor.process.arrays import FloatArray
from advisor.words.certainty import as_sure

LEAST_TRAINED = 2
"""Least number of manoeuvres for a fit, because a single one identifies no effect."""
_EVERY = 3
"""One in this number of manoeuvres is held out, as in the folds of the search."""
_OFFSET = "alpha_bias"


@dataclass(frozen=True)
class UnseenManeuvers:
    """Held-out manoeuvres, and an answer without them."""

    kept: tuple[int, ...]
    """Indices of the held-out manoeuvres, in the problem of the whole diagnosis."""
    examined: Examined
    """Diagnosis of all manoeuvres, with derivatives and sizes fitted without the held-out ones."""


def kept_apart(n: int, holdout: int | None) -> tuple[int, ...]:
    """Return the indices of the held-out manoeuvres: the last ``holdout`` ones, or every third.

    The result is empty if too few manoeuvres would remain for a search.
    """
    kept = range(n - holdout, n) if holdout is not None and 0 < holdout < n else range(1, n, _EVERY)
    return tuple(kept) if n - len(kept) >= LEAST_TRAINED else ()


def changes_something(diagnosis: Diagnosis) -> bool:
    """Return whether a diagnosis changes the simulator. Moving air alone does not change the simulator."""
    shrink = diagnosis.shrink
    if shrink is None:
        return False
    of_numbers = shrink.beyond_air_percent is not None or shrink.by_numbers_percent is not None
    named = any(cause.present and cause.block != "air" for cause in diagnosis.causes)
    return diagnosis.verdict == "parameters" or named or of_numbers


def unseen_of(whole: Examined, holdout: int | None) -> UnseenManeuvers | None:
    """Return a diagnosis with sizes fitted without the held-out manoeuvres; None if too few remain.

    ``holdout`` has the meaning of ``advisor.gap.diagnose.examine``.
    """
    numbers = [flight.number for flight in whole.findings.problem.flights.flights]
    kept = kept_apart(len(numbers), holdout)
    return UnseenManeuvers(kept, sized_without(whole, [numbers[i] for i in kept])) if kept else None


def sized_without(examined: Examined, apart: Collection[int]) -> Examined:
    """Return a diagnosis with derivatives and sizes of effects from fits without some manoeuvres.

    The effects themselves are selected on all manoeuvres. ``apart`` holds the numbers of the manoeuvres that
    the fits exclude.
    """
    problem, diagnosis = examined.findings.problem, examined.diagnosis
    out = [i for i, flight in enumerate(problem.flights.flights) if flight.number in apart]
    models = []
    for step in examined.findings.models:
        seen = replace(problem, flights=step.flights or problem.flights)
        models.append(replace(step, fitted=fit(seen, step.fitted.point, step.fitted.noise, aside=out)))
    point = models[-1].fitted.point
    slopes = zip(DERIVATIVES, point.derivatives.tolist(), strict=True)
    effects = {effect: dict(sizes) for effect, sizes in diagnosis.effects.items()}
    for variant, values in zip(point.effects, point.values, strict=True):
        effect = "thrust_moment" if variant == PROPELLER else variant.effect
        if effect in effects:
            sizes = parameters_of(variant, values, np.zeros(len(values)))
            effects[effect] |= {name: size.value for name, size in sizes.items()}
    model = {name: replace(diagnosis.model[name], value=value) for name, value in slopes}
    sized = replace(diagnosis, model={**diagnosis.model, **model}, effects=effects)
    return replace(examined, diagnosis=sized, findings=replace(examined.findings, models=tuple(models)))


def as_changed(unseen: UnseenManeuvers, whole: Examined) -> SearchPoint:
    """Return the model of an export, for all manoeuvres.

    Nuisance parameters belong to the flight, not to the simulator; only the propeller's are exported. Initial
    states, and the side on which play rests, start from the whole diagnosis.
    """
    examined, everything = unseen.examined, whole.findings.last.fitted.point
    point, written = examined.findings.last.fitted.point, examined.diagnosis.effects
    with_propeller = not written.get("thrust_moment", {}).keys().isdisjoint(PROPELLER.names)
    kept = [
        k
        for k, effect in enumerate(point.effects)
        if (with_propeller if effect == PROPELLER else not effect.is_nuisance and effect.effect in written)
    ]
    return replace(point.keeping(kept), own=everything.own, sides=everything.sides, edges=None)


def predicted(
    problem: EffectProblem,
    model: SearchPoint,
    fitted: EffectFit,
    floor: FloatArray,
    kept: Sequence[int],
    offset_rad: float = 0.0,
) -> HeldOut:
    """Return the residuals of a model, with mean squares over the held-out manoeuvres.

    The model flies with the flight's nuisance parameters, fitted together with the model's derivatives
    without the held-out manoeuvres. Initial state, trim and offsets of each manoeuvre are refitted, weighted
    by ``floor``, shape (channels,).

    Parameters
    ----------
    fitted
        Fit of the flight, whose nuisance parameters start the search. The fit includes the model's effects,
        if the model has any.
    offset_rad
        Offset of α that was removed from the data and that the model does not contain.
    """
    aside = kept if len(kept) < len(problem.flights) else ()
    flown = with_natural(problem, model, fitted.point, fitted.noise, aside)
    plain = replace(problem, whitening=None)
    held = own_refitted(plain, replace(flown, edges=None), floor)
    return over_maneuvers(plain, with_offset(plain, held, offset_rad) if offset_rad else held, kept)


def unknown_offset(whole: Diagnosis, model: Diagnosis | None) -> float:
    """Return the offset of α that was removed from the data and that ``model`` does not contain, rad.

    Parameters
    ----------
    model
        Diagnosis on which the model is based; None for a simulator as given.
    """
    removed = whole.effects.get(_OFFSET, {}).get("bias_rad", 0.0)
    written = 0.0 if model is None else model.effects.get(_OFFSET, {}).get("bias_rad", 0.0)
    return removed - written


@dataclass(frozen=True)
class Flown:
    """Residuals of a simulator on held-out manoeuvres, before and after corrections."""

    before: HeldOut
    after: HeldOut | None
    """Residuals after corrections; None without a correction, or if the simulator did not fly."""
    gap_before: float
    gap_after: float
    """Gap after the part of the correction that the simulator supports."""
    on_paper: tuple[str, ...] = ()
    """Corrections that the simulator does not support, so that its flights cannot contradict them."""
    gap: InSimulator | None = None
    """Gap for the report; None for the model of an aircraft file."""


def by_the_file(whole: Examined, unseen: UnseenManeuvers) -> Flown:
    """Return the file model's residuals before and after the correction from the other manoeuvres."""
    diagnosis, problem, floor = whole.diagnosis, whole.findings.problem, floor_of(whole)
    assert problem.prior_derivatives is not None
    plain = unseen.examined.findings.models[0].fitted
    given = SearchPoint(problem.prior_derivatives, whole.findings.last.fitted.point.own)
    before = after = predicted(problem, given, plain, floor, unseen.kept, unknown_offset(diagnosis, None))
    if changes_something(unseen.examined.diagnosis):
        offset = unknown_offset(diagnosis, unseen.examined.diagnosis)
        own = unseen.examined.findings.last.fitted
        after = predicted(problem, as_changed(unseen, whole), own, floor, unseen.kept, offset)
    was, now = (whole_gap(held.mean_square, floor) for held in (before, after))
    return Flown(before, after, was, now)


def shrink_on(
    whole: Examined, unseen: UnseenManeuvers, before: HeldOut, after: HeldOut | None
) -> Shrink | None:
    """Return the shrink from ``before`` to ``after`` on the held-out manoeuvres."""
    shrink = whole.diagnosis.shrink
    if shrink is None or after is None:
        return None
    floor, kept = floor_of(whole), list(unseen.kept)
    was, now = (whole_gap(held.mean_square, floor) for held in (before, after))
    percent = percent_of(was, now)
    low, high = shrink_interval(before.by_maneuver[kept], after.by_maneuver[kept], floor)
    flights = whole.findings.problem.flights.flights
    return replace(
        shrink,
        holdout=tuple(flights[i].number for i in kept),
        before=was, after=now, percent=percent, ci95_percent=(min(low, percent), max(high, percent)),
    )  # fmt: skip


def resaid(diagnosis: Diagnosis, shrink: Shrink | None, aircraft: Aircraft) -> Diagnosis:
    """Return the diagnosis with another shrink, also in its sentence, with unchanged certainty."""
    d = diagnosis
    sentence = sentence_of(d.verdict, d.gap, d.where, d.causes, shrink, in_simulator(aircraft))
    return replace(d, shrink=shrink, sentence=as_sure(sentence, answers_of(d.evidence)))


def percent_of(was: float, now: float) -> float:
    """Return the shrink of a gap in per cent of its first value."""
    return 100.0 * (1.0 - now / was) if was > 1e-9 else 0.0


def floor_of(whole: Examined) -> FloatArray:
    """Return the noise floor of the diagnosis, shape (channels,)."""
    return np.array([whole.diagnosis.gap.floor[c] for c in whole.findings.problem.channels])


def without_worse(
    whole: Examined, unseen: UnseenManeuvers, measure: Callable[[UnseenManeuvers], Flown]
) -> tuple[Examined, Flown]:
    """Return the diagnosis without further effects that visibly increase the gap, and the measurement without
    them.

    The candidate sets are the first effect alone, then one more effect each, in the order of the search.
    First the set with the least gap on manoeuvres held out in turn is kept. Then the set with the least gap
    on held-out manoeuvres is kept. A sentence names each withdrawn effect. If the whole correction increases
    the gap, the diagnosis offers no improved simulator.
    """
    whole = without_raised(whole)
    examined = unseen.examined
    every = best = measure(unseen)
    if every.on_paper:
        return whole, every
    stay = len(examined.named)
    for most in reversed(range(1, stay)):
        tried = measure(replace(unseen, examined=_shortened(examined, most)))
        if tried.gap_after < best.gap_after - VISIBLE:
            best, stay = tried, most
    numbers = [flight.number for flight in whole.findings.problem.flights.flights]
    kept = unused([numbers[i] for i in unseen.kept])
    if best.gap_after > best.gap_before + VISIBLE:
        said = taken_back_said(["every correction"], kept, best.gap_after, best.gap_before)
        diagnosis = replace(
            whole.diagnosis, taken_back=(*whole.diagnosis.taken_back, said), shrink=None, corrects=False
        )
        return replace(whole, diagnosis=diagnosis), best
    taken = [k for k, name in enumerate(whole.named) if name in examined.named[stay:]]
    if not taken:
        return whole, every
    return _without(whole, taken[0], kept, every.gap_after, best.gap_after), best


def _shortened(asked: Examined, most: int) -> Examined:
    """Return a diagnosis with at most the first ``most`` effects, measured with their model."""
    gone, models = asked.named[most:], asked.findings.models[: most + 1]
    left = {effect: sizes for effect, sizes in asked.diagnosis.effects.items() if effect not in gone}
    causes = tuple(
        replace(cause, present=cause.present and cause.effect not in gone) for cause in asked.diagnosis.causes
    )
    return replace(
        asked,
        diagnosis=replace(asked.diagnosis, effects=left, causes=causes),
        findings=replace(asked.findings, models=(*models[:-1], replace(models[-1], added=None))),
    )


def without_raised(whole: Examined) -> Examined:
    """Return a diagnosis without the further effects that increase the gap on manoeuvres held out in turn."""
    gaps = [whole_gap(model.held_out.mean_square, floor_of(whole)) for model in whole.findings.models]
    stay = len(whole.named)
    for most in reversed(range(1, stay)):
        if gaps[most] < gaps[stay] - VISIBLE:
            stay = most
    if stay == len(whole.named):
        return whole
    return _without(whole, stay, "manoeuvres held out in turn", gaps[-1], gaps[stay])


def _without(whole: Examined, most: int, flown: str, worse: float, better: float) -> Examined:
    """Return a diagnosis with at most the first ``most`` effects, which names the others and their gap."""
    effects = [spelled(effect) for effect in whole.named[most:]]
    said = (*whole.diagnosis.taken_back, taken_back_said(effects, flown, worse, better))
    stays = whole.with_most(most)
    return replace(stays, diagnosis=replace(stays.diagnosis, taken_back=said), fewer=whole.fewer)


def with_unseen_shrink(whole: Examined, unseen: UnseenManeuvers, aircraft: Aircraft) -> Examined:
    """Return the diagnosis against an aircraft file's model, with the shrink on held-out manoeuvres."""
    if whole.findings.problem.prior_derivatives is None:
        return whole
    stays, flown = without_worse(whole, unseen, partial(by_the_file, whole))
    if not stays.diagnosis.improves:
        return stays
    shrink = shrink_on(stays, unseen, flown.before, flown.after)
    return replace(stays, diagnosis=resaid(stays.diagnosis, shrink, aircraft))


def unused(maneuvers: Sequence[int]) -> str:
    """Return in words the manoeuvres that no fit has used."""
    plural = "s" if len(maneuvers) > 1 else ""
    return f"manoeuvre{plural} {', '.join(map(str, maneuvers))}, which no fit has used"


def taken_back_said(parts: Sequence[str], flown: str, worse: float, better: float) -> str:
    """Return the sentence about corrections that increase the gap of the manoeuvres ``flown``."""
    gap = f"the gap is {worse:.3g} instead of {better:.3g}"
    return f"Taken back: {' and '.join(parts)}, with which {gap} on {flown}."
