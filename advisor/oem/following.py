"""Estimate of a manoeuvre in flight, refreshed at every sample.

Each refresh of the estimate uses all data so far, fits all parameters and corrects the errors. Most
refreshes update the last solution with the newest samples (``carried``). Twice per second the model is
solved anew over all data, from the last optimum. The noise model, and the use of the angle of attack, are
checked every two seconds. One more step allows for the servo's lag and the command's delay (``Doubt``).
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.carried import UpdatableSolution
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import report
from advisor.oem.extra import Prior
from advisor.oem.identifiability import too_wide
from advisor.oem.instrument_fit import colour_share, weighed
from advisor.oem.instruments import OF_ALPHA, Instrument, extra_of, unknown_instruments
from advisor.oem.prepare import prepare
from advisor.oem.solution import Solution, evaluate, solve
from advisor.process.arrays import FloatArray

N = len(PARAMETERS)


@dataclass(frozen=True, slots=True)
class Doubt:
    """Additional uncertainty of an estimate because instruments of the command are unknown.

    The servo's lag and delay have priors, and the samples limit their errors. One joint Gauss-Newton step of
    derivatives and instruments moves the estimate. The joint covariance widens the estimate's errors.
    """

    step: FloatArray
    """Shape (8,): step of the derivatives by the unknown instruments."""
    covariance: FloatArray
    """Shape (8, 8): addition to the derivatives' covariance."""
    covariance_cr: FloatArray
    """Shape (8, 8): addition to the derivatives' Cramér-Rao bound."""

    @classmethod
    def about(cls, solution: Solution, aircraft: Aircraft) -> "Doubt":
        """Return the instruments' uncertainty for a solution; none if the samples do not determine a step."""
        share = colour_share(solution)
        names = [weighed(x, share) for x in _with_priors(solution, aircraft)]
        optimum = solution.optimum
        extra = extra_of(solution.problem, solution.assembly, optimum.shared, optimum.local, names)
        joint = evaluate(solution.problem, solution.assembly, optimum, extra)
        if not isinstance(joint, Solution):
            return cls(np.zeros(N), np.zeros((N, N)), np.zeros((N, N)))
        step = joint.influence.step(solution.residual, extra)[:N]
        wider = joint.covariance[:N, :N] - solution.covariance[:N, :N]
        return cls(step, wider, joint.covariance_cr[:N, :N] - solution.covariance_cr[:N, :N])

    def on(self, estimate: Estimate) -> Estimate:
        """Return the solution's estimate, or a later one, with the instruments' uncertainty."""
        moved = replace(
            estimate,
            theta=estimate.theta + self.step,
            covariance=estimate.covariance + self.covariance,
            covariance_cr=estimate.covariance_cr + self.covariance_cr,
        )
        wide = {**too_wide(moved.theta, moved.std), **estimate.not_identifiable}
        return replace(moved, not_identifiable=wide)


def _with_priors(solution: Solution, aircraft: Aircraft) -> Iterator[Instrument]:
    """Yield the instruments of the command that have a prior or a stated tolerance."""
    for x in unknown_instruments(solution.problem, aircraft):
        width = x.known_to * abs(x.stated or 0.0)
        if x.name not in OF_ALPHA and (x.stated is None or width > 0.0):
            yield x if x.stated is None else replace(x, prior=Prior(x.read(solution.problem), width))


CARRY_S = 0.5
"""Time in s after which the model is solved again over all samples. The air speed, taken as constant, changes
by up to 4 % within this time (``logs/arduplane-calm.tlog``)."""
COLOUR_EVERY_S = 2.0
"""Time in s between two fits of the noise model, and between two checks of the angle of attack."""

CLOSE_ENOUGH = 1e-4
"""Promised change of log J per sample at which a refresh ends: hundredths of a standard deviation."""


class Follower:
    """Estimator that follows one manoeuvre after another, and restarts when the manoeuvre's number
    changes."""

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._number: int | None = None
        self._last: Solution | None = None
        self._carried: UpdatableSolution | None = None
        self._left_out: str | None = None
        self._doubt: Doubt | None = None
        self._solved_s = self._coloured_s = -math.inf

    def refresh(self, maneuver: Maneuver) -> Estimate | NoEstimate:
        """Return the estimate from the part of the manoeuvre flown so far."""
        if maneuver.number != self._number:
            self._number, self._last, self._carried, self._coloured_s = maneuver.number, None, None, -math.inf
        now_s = float(maneuver.channels["q"].t[-1]) if maneuver.channels["q"] else -math.inf
        if self._carried is not None and now_s < self._solved_s + CARRY_S:
            carried = self._carried.on(maneuver)
            if carried is not None and self._doubt is not None:
                return self._doubt.on(carried)
        return self._complete(maneuver, now_s)

    def _complete(self, maneuver: Maneuver, now_s: float) -> Estimate | NoEstimate:
        self._carried, again = None, now_s < self._coloured_s + COLOUR_EVERY_S
        prepared = prepare([maneuver], self._aircraft, alpha_left_out=self._left_out if again else None)
        if isinstance(prepared, NoEstimate):
            return prepared
        self._left_out = prepared.alpha_left_out
        last = self._last
        if last is None or last.noise.colours.keys() != prepared.problem.records[0].outputs.keys():
            solution, again = solve(prepared.problem), False
        else:
            solution = solve(
                prepared.problem,
                begin=(last.optimum.shared, last.optimum.local),
                flat=CLOSE_ENOUGH,
                noise=last.noise if again else None,
            )
        self._solved_s, self._coloured_s = now_s, self._coloured_s if again else now_s
        self._last = solution if isinstance(solution, Solution) else None
        if isinstance(solution, NoEstimate):
            return solution
        estimate = report(solution, prepared, self._aircraft, quick=True)
        self._carried = UpdatableSolution(solution, prepared, estimate)
        self._doubt = Doubt.about(solution, self._aircraft)
        return self._doubt.on(estimate)
