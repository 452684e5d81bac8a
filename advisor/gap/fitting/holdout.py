"""Hold-out: prediction error of a model on manoeuvres that were left out of its fit.

The fit is linear about the optimum. The omission of a fold moves the shared parameters by (H − H_f)⁻¹ g_f,
without a simulation. Only the nuisance parameters of a held-out manoeuvre are refitted. Folds are interleaved
and rotated, because a gust or a change may fall into any fold.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.fit import EffectFit, rms_of
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.fitting.step import bounds_of, own_eliminated
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import DERIVATIVES, HEIGHT, SPEED, THROTTLE
from advisor.oem.arrow import solved_within
from advisor.process.arrays import FloatArray

_INDIFFERENT = 3e-4
"""Numerical: relative information below which a direction of the shared parameters is kept fixed. Such a
direction changes no prediction, but a long step leaves the range in which the model is linear."""
_ANCHOR = 1e-3
"""Prior: weight of the prior "no effect", over the information of all manoeuvres on a parameter. The prior's
standard deviation is at least the parameter's own size."""
_SOLE_SHARE = 0.9
"""Share of the information on a parameter above which a single manoeuvre counts as its only source."""
_NEEDED = (SPEED, THROTTLE, HEIGHT)
"""Rows of the slow inputs (air speed, throttle, height) that some effects need."""


@dataclass(frozen=True)
class HeldOut:
    """Residuals of every manoeuvre as predicted by a fit of the other folds."""

    residuals: tuple[FloatArray, ...]
    """Per manoeuvre: residuals of the stacked channels, in the channels' units."""
    innovations: tuple[FloatArray, ...]
    """Per manoeuvre: whitened residuals."""
    mean_square: FloatArray
    """Shape (channels,): mean square of the residuals."""
    innovation_square: FloatArray
    """Shape (channels,): mean square of the innovations."""
    by_maneuver: FloatArray
    """Shape (manoeuvres, channels): mean squares of the residuals."""


def folds_of(n: int, shifted: bool = False) -> list[list[int]]:
    """Return three interleaved folds of manoeuvres; fewer than three manoeuvres give one fold each.

    ``shifted`` puts manoeuvres that lie three apart into different folds.
    """
    k = min(3, n)
    fold = [(i + shifted * (i // k)) % k for i in range(n)]
    return [[i for i in range(n) if fold[i] == j] for j in range(k)]


def folds_for(flights: PreparedManeuvers) -> list[list[int]]:
    """Return folds in which manoeuvres with rare information are separated, so that each can confirm the
    other.

    If throttle, height or air speed varies in two manoeuvres only, each of two folds holds one of them. A
    fold with both manoeuvres would leave no information in the other folds.
    """
    power = np.array([np.var(f.slow[list(_NEEDED)], axis=1) for f in flights.flights])
    shares = power / np.maximum(np.sum(power, axis=0), 1e-300)
    confirmable = shares[:, np.max(shares, axis=0) < _SOLE_SHARE]

    def together(folds: list[list[int]]) -> float:
        return max(float(np.max(np.sum(confirmable[fold], axis=0), initial=0.0)) for fold in folds)

    n = len(flights)
    interleaved, shifted = folds_of(n), folds_of(n, shifted=True)
    return shifted if together(interleaved) > _SOLE_SHARE > together(shifted) else interleaved


def hold_out(
    problem: EffectProblem, fitted: EffectFit, folds: Sequence[Sequence[int]] | None = None
) -> HeldOut:
    """Predict every fold of manoeuvres from a fit of the other folds. A single manoeuvre has the residuals of
    its own fit."""
    n = len(problem.flights)
    residuals: list[FloatArray] = [np.empty(0)] * n
    innovations: list[FloatArray] = [np.empty(0)] * n
    for fold, step, moved in _without_each(problem, fitted, folds):
        for i in fold:
            own = moved[i] @ np.append(-step, 1.0)
            innovations[i] = fitted.linear[i].after(step, own)
            residuals[i] = fitted.linear[i].measured.after(step, own)
    return held_out(problem, residuals, innovations)


def _without_each(
    problem: EffectProblem, fitted: EffectFit, folds: Sequence[Sequence[int]] | None
) -> Iterator[tuple[Sequence[int], FloatArray, Sequence[FloatArray]]]:
    """Yield each fold, the shared step without it, and the nuisance parameters' response."""
    n = len(problem.flights)
    chosen = folds_for(problem.flights) if folds is None else folds
    weights = 1.0 / fitted.noise
    blocks = [own_eliminated(block, weights) for block in fitted.linear]
    inner = np.array([b[0] for b in blocks])
    information, gradients = inner[:, :-1, :-1], inner[:, :-1, -1]
    total_H, total_g = np.sum(information, axis=0), np.sum(gradients, axis=0)
    k = len(DERIVATIVES)
    precision, departure = problem.prior_of(fitted.point)
    total_H += np.diag(precision)
    total_g += precision * departure
    lower, upper = bounds_of(fitted.point)
    far = fitted.point.shared - _without_effect(fitted.point)
    anchor = np.minimum(_ANCHOR * marginal_information(total_H), 1.0 / np.maximum(far**2, 1e-300))
    anchor[:k] = 0.0
    # Where a response has kinks, the search rejected this step of the linear model, so it is subtracted.
    least, most = lower - fitted.point.shared, upper - fitted.point.shared
    refused = solved_within(total_H, total_g, least, most, _INDIFFERENT)
    for fold in chosen:
        step = np.zeros(len(total_g))
        if len(fold) < n:
            # A parameter that only the held-out manoeuvres determine stays at "no effect", or where it is.
            H = total_H - np.sum(information[list(fold)], axis=0) + np.diag(anchor)
            g = total_g - np.sum(gradients[list(fold)], axis=0) - anchor * far
            step = solved_within(H, g, least, most, _INDIFFERENT) - refused
            step = np.clip(step, least, most)
        yield fold, step, [block[1] for block in blocks]


def _without_effect(point: SearchPoint) -> FloatArray:
    """Return the shared parameters, shape (k,), with the size of every effect set to zero."""
    names = [[name in effect.places for name in effect.names] for effect in point.effects]
    stays = np.concatenate([np.ones(len(DERIVATIVES), dtype=bool), *(np.array(n, dtype=bool) for n in names)])
    return np.where(stays, point.shared, 0.0)


def measured_in(
    problem: EffectProblem, held: HeldOut, fitted: EffectFit, sole_maneuvers: Collection[int]
) -> HeldOut:
    """Return the hold-out with the fit's residuals in some manoeuvres.

    Each manoeuvre in ``sole_maneuvers`` alone determines some parameter, so no other manoeuvre predicts it.
    """

    def chosen(inside: Sequence[FloatArray], kept_out: Sequence[FloatArray]) -> list[FloatArray]:
        pairs = enumerate(zip(inside, kept_out, strict=True))
        return [seen if i in sole_maneuvers else unseen for i, (seen, unseen) in pairs]

    innovations = chosen(fitted.innovations, held.innovations)
    return held_out(problem, chosen(fitted.residuals, held.residuals), innovations)


def sole_informative_maneuver(fitted: EffectFit, index: int) -> int | None:
    """Return the only manoeuvre that determines a shared parameter; None if another manoeuvre could confirm
    the parameter.
    """
    weights = 1.0 / fitted.noise
    information = [own_eliminated(block, weights)[0][index, index] for block in fitted.linear]
    return int(np.argmax(information)) if max(information) > _SOLE_SHARE * sum(information) else None


def held_out(
    problem: EffectProblem, residuals: Sequence[FloatArray], innovations: Sequence[FloatArray] | None = None
) -> HeldOut:
    """Return residuals with their mean squares. Without ``innovations`` the residuals serve as
    innovations."""
    whitened = tuple(residuals if innovations is None else innovations)
    return HeldOut(
        tuple(residuals), whitened,
        rms_of(problem, residuals) ** 2, rms_of(problem, whitened) ** 2, mean_squares(problem, residuals),
    )  # fmt: skip


def mean_squares(problem: EffectProblem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Return the mean squares of residuals, shape (manoeuvres, channels)."""
    return np.array(
        [
            [float(np.mean(residual[rows] ** 2)) for rows in problem.rows(f)]
            for f, residual in zip(problem.flights.flights, residuals, strict=True)
        ]
    )


def marginal_information(H: FloatArray) -> FloatArray:
    """Return the information on each parameter with all others unknown, 1 / (H⁻¹)_jj, shape (k,)."""
    scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
    widened = np.diag(np.linalg.pinv(H / np.outer(scale, scale), hermitian=True))
    # At least one by definition; a smaller value means that the data say nothing at all.
    return np.asarray(scale**2 / np.maximum(widened, 1.0))
