"""The addition of an effect to a model, judged on held-out manoeuvres."""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import BEYOND_DOUBT, LEAST_GAIN, LEAST_SIGMA
from advisor.gap.effects import effect_named
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import (
    HeldOut,
    hold_out,
    mean_squares,
    measured_in,
    sole_informative_maneuver,
)
from advisor.gap.fitting.prior import log_odds_of_arm
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.fitting.uncertainty import covariance, log_prior_of, sigmas_of
from advisor.gap.kit.variant import Variant
from advisor.gap.records.floor import floor_margins
from advisor.gap.result import VISIBLE
from advisor.gap.search.acceptance import LEAST_SUPPORT, JudgedAddition, size_of

_FAINT = 0.15
"""Share of the least change that is enough for an effect that is certain, in still air and without another
effect. Effects that every aircraft has are excepted. A time must be twice its least size then, and so must a
step that may lie between any two manoeuvres."""
_OF_PEAK = 0.003
"""Least change of the outputs by an effect, as a share of each channel's peak."""
TIMES = frozenset({"delay_s", "lag_s", "skew_s"})
"""Parameters that are times."""
TIME_ERROR_S = 0.0006
"""Prior: error of a delay, lag or skew in s, for the simulation's grid and the resolution of the stamps."""
_ANY_TIME = 1.5
"""Factor on the physical minimum for a step that may lie between any two manoeuvres."""


def smallest_of(problem: EffectProblem, variant: Variant, gain: float = 0.0) -> float:
    """Return the least size of an effect's first parameter for acceptance, given the jitter of the stamps.

    ``gain`` is the log likelihood that the effect brings.
    """
    smallest = variant.smallest * (variant.if_beyond_doubt if gain >= BEYOND_DOUBT else 1.0)
    if variant.names[0] in TIMES:
        return smallest + TIME_ERROR_S + LEAST_SIGMA * problem.jitter_s
    return smallest * (_ANY_TIME if variant.comes_at_any_time else 1.0)


def addition(
    problem: EffectProblem,
    before: EffectFit,
    held_before: HeldOut,
    fitted: EffectFit,
    effect: str,
    effective: FloatArray,
) -> JudgedAddition:
    """Judge an effect of a fitted model as an addition to the model without it."""
    point = fitted.point
    k = point.index_of(effect)
    variant, value, place = point.effects[k], point.values[k], point.place(k)
    held = hold_out(problem, fitted)
    # Throttle or height may have moved in one manoeuvre only: without it, the others know nothing.
    sole_maneuver = sole_informative_maneuver(fitted, place.start) if variant.needs else None
    lone = sole_maneuver is not None
    known_before, known = held_before, held
    if others := _sole_maneuvers(fitted, but=k):
        # The others cannot predict that manoeuvre, with or without this effect.
        known_before = measured_in(problem, held_before, before, others)
        known = measured_in(problem, held, fitted, others)
    seen_before, seen_after = (before, fitted) if lone else (known_before, known)
    support = support_of(problem, known_before, known)
    likelihood = log_likelihood_gained(
        before, known_before, fitted, known, effective, None if lone else support
    )
    likelihood += 0.5 * (price_of_edges(problem, before) - price_of_edges(problem, fitted))
    likelihood += 0.5 * (problem.nuisance_cost(before.point) - problem.nuisance_cost(point))
    prior_gain = log_prior_of(problem, fitted, effective) - log_prior_of(problem, before, effective)
    odds = log_odds_in(problem, variant.effect, float(value[0]))
    least = least_change(problem)
    gain = likelihood + prior_gain + odds - price_of(variant, effective)
    known_numbers = covariance(problem, fitted, effective, trusted=prior_gain >= LEAST_GAIN)[place, place]
    located = [name in variant.places for name in variant.names]
    return JudgedAddition(
        variant=variant, fitted=fitted, held_out=held,
        gain=gain,
        removed=difference(problem, seen_before, seen_after, sole_maneuver),
        support=support,
        least=least, least_certain=least * _share_enough(problem, before, variant, value),
        smallest=smallest_of(problem, variant, gain),
        prior_gain=prior_gain, value=value, sole_maneuver=sole_maneuver,
        with_the_air=bool(variant.needs) and problem.knows_the_noise,
        std=np.sqrt(np.maximum(np.diag(known_numbers), 0.0)), sigmas=sigmas_of(value, known_numbers, located),
    )  # fmt: skip


def _sole_maneuvers(fitted: EffectFit, but: int) -> set[int]:
    """Return the manoeuvres that alone determine some effect of the model, other than the ``but``-th."""
    point = fitted.point
    others = [k for k, v in enumerate(point.effects) if v.needs and not v.is_nuisance and k != but]
    found = (sole_informative_maneuver(fitted, point.place(k).start) for k in others)
    return {number for number in found if number is not None}


def price_of(variant: Variant, effective: FloatArray) -> float:
    """Return k/2 ln N for the k parameters of an effect, plus one for a choice among variants (Schwarz)."""
    numbers = len(variant.names) + (1 if variant.fixed else 0)
    return 0.5 * numbers * float(np.log(np.sum(effective)))


def log_odds_in(problem: EffectProblem, effect: str, size: float) -> float:
    """Return the log prior odds of an arm of that size; 0 for other effects."""
    return log_odds_of_arm(effect, size, problem.arms_in_file, problem.flights.alpha_is_derived)


def log_likelihood_gained(
    before: EffectFit,
    held_before: HeldOut,
    after: EffectFit,
    held_after: HeldOut,
    effective: FloatArray,
    support: float | None = -np.inf,
) -> float:
    """Return the gain in log likelihood on held-out manoeuvres, but at most that of the fit.

    A loss within the standard error of ``support`` counts as none. With a support of None no other manoeuvre
    can confirm the effect, so the fit alone decides.
    """
    fitted, kept_out = (
        float(np.sum(effective / 2.0 * np.log(ratio)))
        for ratio in (
            (before.noise / after.noise) ** 2, held_before.innovation_square / held_after.innovation_square,
        )
    )  # fmt: skip
    if support is None:
        return fitted
    return min(fitted, max(kept_out, 0.0) if support > -LEAST_SUPPORT else kept_out)


def _share_enough(problem: EffectProblem, before: EffectFit, variant: Variant, value: FloatArray) -> float:
    """Return the share of the least change that is enough where an effect is certain."""
    by_nature = effect_named(variant.effect).by_nature
    if not is_baseline(before) or problem.knows_the_noise or by_nature:
        return 1.0
    times = 2.0 if variant.names[0] in TIMES or variant.comes_at_any_time else 1.0
    return _FAINT if size_of(variant, value) >= times * smallest_of(problem, variant) else 1.0


def is_baseline(before: EffectFit) -> bool:
    """Return whether the model has only nuisance parameters, and no effect yet."""
    return all(effect.is_nuisance for effect in before.point.effects)


def price_of_edges(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return the cost of edges and air speeds away from their likely values: all but noise and prior.

    A wrong model buys some of its fit by shifting them.
    """
    noise = float(np.sum(counts(problem) * 2.0 * np.log(fitted.noise)))
    return fitted.cost - noise - problem.prior_cost(fitted.point)


def least_change(problem: EffectProblem) -> float:
    """Return the least mean square change of the outputs for a named effect, relative to the instruments'
    noise.

    With very good instruments their noise does not limit. A low-order description is itself no better than a
    share of each channel's peak.
    """
    if problem.instruments is None:
        return VISIBLE
    return max(VISIBLE, float(_OF_PEAK**2 / np.mean((problem.instruments / problem.flights.peaks) ** 2)))


def support_of(problem: EffectProblem, before: HeldOut, after: HeldOut) -> float:
    """Return by how many standard errors over manoeuvres the second model lowers the held-out gap of the
    first.

    The gap is that of the innovations, as in the likelihood: air that no model predicts decides on no effect.
    Only channels that identify a cause count (``Flights.telling``). 0 for a single manoeuvre.
    """
    noise = np.ones(len(problem.channels))
    if problem.instruments is not None and not problem.knows_the_noise:
        noise = problem.instruments
    was, now = (mean_squares(problem, held.innovations) for held in (before, after))
    removed = (was - now) / noise**2
    taken = np.mean(removed[:, problem.flights.telling], axis=1)
    n = len(taken)
    if n < 2:
        return 0.0
    error = float(np.std(taken, ddof=1)) / np.sqrt(n)
    return float(np.mean(taken) / max(error, 1e-12))


def difference(
    problem: EffectProblem,
    before: HeldOut | EffectFit,
    after: HeldOut | EffectFit,
    maneuver: int | None = None,
) -> float:
    """Return the squared change of the prediction relative to noise and floor margin, mean over channels.

    ``maneuver`` restricts the mean to one manoeuvre, where no other determines the effect.
    """
    changed = mean_squares(problem, [a - b for a, b in zip(before.residuals, after.residuals, strict=True)])
    noise = 1.0 if problem.instruments is None else problem.instruments * floor_margins(problem.flights)
    power = np.mean(changed, axis=0) if maneuver is None else changed[maneuver]
    return float(np.mean(power / noise**2))
