"""One servo lag for the aircraft, estimated from all manoeuvres when the crew does not know it.

A log holds the command, not the surface. A lag of 0.14 s ignored halves M_α and M_δe of a small
aircraft while the fit still explains 95 % of the motion, so it is looked for: a coarse search,
then Gauss-Newton steps on the lag with all other parameters refitted. It is kept only when the
data tell it from zero; otherwise the command is taken as the surface.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.model.response import N_PARAMETERS, respond
from advisor.oem.covariance import influence
from advisor.oem.estimate import NoEstimate
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.problem import Assembly, Problem, assemble
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.surface import Servo

COARSE_S = (0.0, 0.03, 0.06, 0.1, 0.15, 0.22)
LONGEST_S = 0.4
DIFFERENCE_S = 1e-4
ROUNDS = 8
SETTLED_S = 1e-4
TOLD_APART = 3.0
"""Corrected standard deviations that the lag must lie above zero to be believed."""


@dataclass(frozen=True, slots=True)
class Lag:
    """What was found."""

    solution: Solution
    """With the lag applied when it is believed, without it otherwise."""
    lag_s: float
    """0 when it could not be told from zero."""
    std_s: float
    """Corrected standard deviation; NaN when there is no estimate of it."""


class _Fit(NamedTuple):
    """The optimum at one lag."""

    problem: Problem
    assembly: Assembly
    optimum: Optimum

    @property
    def cost(self) -> float:
        return self.optimum.log_likelihood_cost


def find_lag(problem: Problem, without: Solution) -> Lag:
    """Estimate one first-order lag; ``without`` is the solution with none."""
    plain = _Fit(without.problem, without.assembly, without.optimum)
    best = plain
    for lag_s in COARSE_S[1:]:
        found = _at(problem, lag_s, best)
        if found is None or found.cost > best.cost:
            break
        best = found
    if best is plain:
        best = _at(problem, COARSE_S[1] / 3.0, plain) or plain
    for _ in range(ROUNDS):
        step = _step(best)
        while abs(step) > SETTLED_S:
            lag_s = float(np.clip(best.problem.servo.lag_s + step, SETTLED_S, LONGEST_S))
            found = _at(problem, lag_s, best)
            if found is not None and found.cost < best.cost:
                break
            step /= 4.0
        else:
            break
        best = found
    if best.problem.servo.lag_s <= 2.0 * SETTLED_S:
        return Lag(without, 0.0, float("nan"))
    widened = evaluate(*best, by_lag(best.problem, best.optimum)[:, None])
    if isinstance(widened, NoEstimate):
        return Lag(without, 0.0, float("nan"))
    std = float(np.sqrt(widened.covariance[8, 8]))
    if best.problem.servo.lag_s < TOLD_APART * std or best.cost >= plain.cost:
        return Lag(without, 0.0, std)
    return Lag(widened, best.problem.servo.lag_s, std)


def by_lag(problem: Problem, optimum: Optimum) -> FloatArray:
    """(N,) derivative of the outputs by the servo's lag at the optimum of a problem with a lag."""
    sides = []
    for sign in (-1.0, 1.0):
        servo = Servo(problem.servo.lag_s + sign * DIFFERENCE_S, problem.servo.delay_s)
        grid = assemble(replace(problem, servo=servo)).grid
        y = np.empty(len(optimum.fitted))
        respond(grid, optimum.shared, optimum.local, y, np.empty((0, N_PARAMETERS)))
        sides.append(y)
    derivative: FloatArray = (sides[1] - sides[0]) / (2.0 * DIFFERENCE_S)
    return derivative


def _step(fit: _Fit) -> float:
    """Gauss-Newton step of the lag with everything else free."""
    if fit.problem.servo.lag_s <= SETTLED_S:
        return 0.0
    optimum, extra = fit.optimum, by_lag(fit.problem, fit.optimum)[:, None]
    effect = influence(fit.assembly, optimum.sensitivities, optimum.noise, extra)
    return 0.0 if effect is None else float(effect.rows[:, 8] @ (fit.assembly.z - optimum.fitted))


def _at(problem: Problem, lag_s: float, near: _Fit) -> _Fit | None:
    lagging = replace(problem, servo=Servo(lag_s, problem.servo.delay_s))
    assembly, optimum = search(lagging, begin=(near.optimum.shared, near.optimum.local))
    return _Fit(lagging, assembly, optimum) if optimum.status == CONVERGED else None
