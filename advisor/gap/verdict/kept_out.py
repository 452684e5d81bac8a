"""What the numbers of an answer are measured on: manoeuvres kept out of the fit, and channels as read."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import HeldOut, folds_of, held_out, hold_out
from advisor.gap.fitting.problem import Problem
from advisor.gap.records.flights import Measured
from advisor.gap.search.air import Air
from advisor.gap.search.merit import Judged
from advisor.gap.search.speed import at_constant_speed
from advisor.gap.search.stage import Stage
from advisor.gap.verdict.evidence import Evidence


def keep_out(e: Evidence, holdout: int | None) -> tuple[Evidence, list[int]]:
    """The evidence measured on the last ``holdout`` manoeuvres, by fits without them; and which those are.

    With None, or as many as there are, all: each was kept out in its turn.
    """
    n = len(e.problem.flights)
    if holdout is None or not 0 < holdout < n:
        return e, list(range(n))
    kept = list(range(n - holdout, n))
    folds = [kept, *[[i for i in fold if i not in kept] for fold in folds_of(n)]]

    def predicted(fitted: Fitted) -> HeldOut:
        return over_maneuvers(e.problem, hold_out(e.problem, fitted, folds), kept)

    def judged(one: Judged) -> Judged:
        return replace(one, held_out=predicted(one.fitted))

    stages = [
        Stage(s.fitted, predicted(s.fitted), tuple(map(judged, s.considered)), s.added and judged(s.added))
        for s in e.stages
    ]
    speed = at_constant_speed(e.problem, e.stages[-1].fitted, folds)
    return replace(
        e,
        stages=stages,
        constant_speed=speed and over_maneuvers(e.problem, speed, kept),
        file_model=e.file_model and over_maneuvers(e.problem, e.file_model, kept),
    ), kept


def over_maneuvers(problem: Problem, held: HeldOut, kept: Sequence[int]) -> HeldOut:
    """The mean squares over some manoeuvres only; as in a fit, every sample counts alike."""
    flights = [problem.flights.flights[i] for i in kept]
    samples = np.array([[len(f.outputs[c].t) for c in problem.channels] for f in flights], float)
    sums = np.sum(samples * held.by_maneuver[list(kept)], axis=0)
    return replace(held, mean_square=sums / np.sum(samples, axis=0))


def as_read(problem: Problem, offset_rad: float) -> Problem:
    """The flights with the offset of α in it that was taken out before the fit."""
    flights = tuple(
        replace(
            f,
            outputs={**f.outputs, "alpha": Measured(f.outputs["alpha"].t, f.outputs["alpha"].y + offset_rad)},
        )
        for f in problem.flights.flights
    )
    return replace(problem, flights=replace(problem.flights, flights=flights))


def with_offset(problem: Problem, held: HeldOut, offset_rad: float) -> HeldOut:
    """What a simulator leaves that does not know of the offset of α."""
    c = problem.channels.index("alpha")
    lefts = []
    for flight, left in zip(problem.flights.flights, held.left, strict=True):
        lefts.append(left.copy())
        lefts[-1][problem.rows(flight)[c]] += offset_rad
    return held_out(problem, lefts)


def without_air(held: HeldOut, air: Air) -> HeldOut:
    """Held-out errors with the share of the moving air taken out, alike in every manoeuvre.

    The courses of the errors are those that the air's likeliest course leaves.
    """
    share = np.minimum(air.left / held.mean_square, 1.0)
    powers = held.by_maneuver * share
    return replace(held, left=air.lefts, mean_square=held.mean_square * share, by_maneuver=powers)
