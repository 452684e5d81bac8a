"""Manoeuvres for the numbers of a diagnosis: held out of the fit, with channels as read."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut, folds_for, held_out, hold_out, mean_squares, measured_in
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.findings import Findings, Model
from advisor.gap.search.air import MovingAir
from advisor.oem.prepare import SPEED_CHANGE
from advisor.oem.rows import Signal


def on_holdout(e: Findings, holdout: int | None) -> tuple[Findings, list[int]]:
    """Return the findings on the last ``holdout`` manoeuvres, from fits without these, and their indices.

    With None, or with the number of all manoeuvres, every manoeuvre is held out in turn.
    """
    kept, folds = kept_and_folds(e.problem, holdout)
    if len(kept) == len(e.problem.flights):
        return e, kept
    models = as_measured(
        e.problem, [replace(m, held_out=hold_out(e.problem, m.fitted, folds)) for m in e.models]
    )
    speed = at_constant_speed(e.problem, e.last.fitted, folds)
    return replace(
        e,
        models=tuple(replace(m, held_out=over_maneuvers(e.problem, m.held_out, kept)) for m in models),
        constant_speed=speed and over_maneuvers(e.problem, speed, kept),
        file_model=e.file_model and over_maneuvers(e.problem, e.file_model, kept),
    ), kept


def as_measured(problem: EffectProblem, models: Sequence[Model]) -> tuple[Model, ...]:
    """Return the models with the fit's residuals in manoeuvres that alone determine an effect.

    No other manoeuvre predicts a manoeuvre that alone determines an effect.
    """
    sole: set[int] = set()
    as_held = []
    for model in models:
        held = measured_in(problem, model.held_out, model.fitted, sole) if sole else model.held_out
        as_held.append(replace(model, held_out=held))
        if model.added is not None and model.added.sole_maneuver is not None:
            sole.add(model.added.sole_maneuver)
    return tuple(as_held)


def kept_and_folds(problem: EffectProblem, holdout: int | None) -> tuple[list[int], list[list[int]]]:
    """Return the indices of the manoeuvres for the numbers, and the folds that are held out in turn.

    ``holdout`` is the number of the last manoeuvres; None, or the number of all, means all.
    """
    n, folds = len(problem.flights), folds_for(problem.flights)
    if holdout is None or not 0 < holdout < n:
        return list(range(n)), folds
    kept = list(range(n - holdout, n))
    return kept, [kept, *[[i for i in fold if i not in kept] for fold in folds]]


def over_maneuvers(problem: EffectProblem, held: HeldOut, kept: Sequence[int]) -> HeldOut:
    """Return the hold-out with mean squares over the ``kept`` manoeuvres only; every sample has equal
    weight."""
    flights = [problem.flights.flights[i] for i in kept]
    samples = np.array([[len(f.outputs[c].t) for c in problem.channels] for f in flights], float)
    shares = samples / np.sum(samples, axis=0)
    innovations = mean_squares(problem, held.innovations)
    squares, seen = (np.sum(shares * by[list(kept)], axis=0) for by in (held.by_maneuver, innovations))
    return replace(held, mean_square=squares, innovation_square=seen)


def as_read(problem: EffectProblem, offset_rad: float) -> EffectProblem:
    """Return the flights with the offset of α that was subtracted before the fit."""
    flights = tuple(
        replace(
            f, outputs={**f.outputs, "alpha": Signal(f.outputs["alpha"].t, f.outputs["alpha"].y + offset_rad)}
        )
        for f in problem.flights.flights
    )
    return replace(problem, flights=replace(problem.flights, flights=flights))


def with_offset(problem: EffectProblem, held: HeldOut, offset_rad: float) -> HeldOut:
    """Return the residuals of a simulator without the offset of α."""
    c = problem.channels.index("alpha")
    residuals = []
    for flight, residual in zip(problem.flights.flights, held.residuals, strict=True):
        residuals.append(residual.copy())
        residuals[-1][problem.rows(flight)[c]] += offset_rad
    return held_out(problem, residuals)


def without_air(held: HeldOut, air: MovingAir) -> HeldOut:
    """Return the hold-out without the part of moving air, in every manoeuvre.

    The residuals exclude the likeliest course of the air.
    """
    share = np.minimum(air.mean_square_beyond_air / held.mean_square, 1.0)
    powers = held.by_maneuver * share
    return replace(held, residuals=air.residuals, mean_square=held.mean_square * share, by_maneuver=powers)


def at_constant_speed(
    problem: EffectProblem, fitted: EffectFit, folds: Sequence[Sequence[int]] | None = None
) -> HeldOut | None:
    """Return the refitted model's hold-out with derivatives that do not scale with the air speed.

    None if the air speed hardly varies or was not measured. ``folds`` has the same meaning as in
    ``hold_out``: groups of manoeuvres that are held out together.
    """
    flights = problem.flights
    if flights.speed_moves < SPEED_CHANGE:
        return None
    constant = tuple(f.at_constant_speed() for f in flights.flights)
    frozen = replace(problem, flights=replace(flights, flights=constant))
    return hold_out(frozen, fit(frozen, fitted.point, fitted.noise, iterations=4), folds)
