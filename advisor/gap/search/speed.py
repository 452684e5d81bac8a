"""The cost of ignoring the air speed: the model at constant speed.

The air speed varies in every flight, because a manoeuvre exchanges it for height. A simulator with the
measured speed knows that.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import HeldOut, hold_out
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import SPEED_CHANGE


def at_constant_speed(
    problem: EffectProblem, fitted: EffectFit, folds: Sequence[Sequence[int]] | None = None
) -> HeldOut | None:
    """Return the hold-out of the model with derivatives that do not scale with the air speed, refitted.

    None where the speed hardly varies, or was not measured. ``folds`` are those of ``hold_out``.
    """
    flights = problem.flights
    if flights.speed_moves < SPEED_CHANGE:
        return None
    constant = tuple(f.at_constant_speed() for f in flights.flights)
    frozen = replace(problem, flights=replace(flights, flights=constant))
    return hold_out(frozen, fit(frozen, fitted.point, fitted.noise, iterations=4), folds)
