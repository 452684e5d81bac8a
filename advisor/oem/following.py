"""The estimate of a manoeuvre in flight, refreshed at every sample.

Each refresh is complete: all data so far, all parameters, corrected errors. Most refreshes update the last
solution with the newest samples (``carried``). Twice per second the model is solved anew over all data, from
the last optimum. The noise model, and the use of the angle of attack, are checked every two seconds. Servo
lag and delay of the command are allowed for by one more step (``doubt``).
"""

import math

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.carried import UpdatableSolution
from advisor.oem.doubt import Doubt
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import report
from advisor.oem.prepare import prepare
from advisor.oem.solution import Solution, solve

CARRY_S = 0.5
"""Time in s after which the model is solved anew. The air speed, taken as constant, changes by up to 4 % in
it (``logs/arduplane-calm.tlog``)."""
COLOUR_EVERY_S = 2.0
"""Time in s between two fits of the noise model, and between two checks of the angle of attack."""

CLOSE_ENOUGH = 1e-4
"""Promised change of log J per sample at which a refresh ends: hundredths of a standard deviation."""


class Follower:
    """An estimator that follows one manoeuvre after another, and restarts when the manoeuvre's number
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
        """Estimate from the manoeuvre as far as it has been flown."""
        if maneuver.number != self._number:
            self._number, self._last, self._carried, self._coloured_s = maneuver.number, None, None, -math.inf
        now_s = float(maneuver.channels["q"].t[-1]) if maneuver.channels["q"] else -math.inf
        if self._carried is not None and now_s < self._solved_s + CARRY_S:
            found = self._carried.on(maneuver)
            if found is not None and self._doubt is not None:
                return self._doubt.on(found)
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
        found = report(solution, prepared, self._aircraft, quick=True)
        self._carried = UpdatableSolution(solution, prepared, found)
        self._doubt = Doubt.about(solution, self._aircraft)
        return self._doubt.on(found)
