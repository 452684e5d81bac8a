"""The estimate of a manoeuvre while it is being flown, refreshed at every sample.

Each refresh is complete: all data so far, all parameters, corrected errors. Most refreshes carry the last
solution on over the newest samples (``carried``). Twice a second the model is solved anew over all data, from
where the last search ended. What changes slowly, the colour of the noise and whether the angle of attack
counts, is found out every two seconds.
"""

import math

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.oem.carried import Carried
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import report
from advisor.oem.prepare import prepare
from advisor.oem.solution import Solution, solve

CARRY_S = 0.5
"""Flight over which a solution is carried on. The air speed, taken as constant, changes by up to 4 % in it
(``logs/arduplane-calm.tlog``)."""
COLOUR_EVERY_S = 2.0
"""Flight between two fits of the noise's colour, and between two checks of the angle of attack."""

CLOSE_ENOUGH = 1e-4
"""Promised change of log J per sample at which a refresh is done: hundredths of a standard deviation."""


class Follower:
    """Follows one manoeuvre after another; begins anew when the manoeuvre's number changes."""

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._number: int | None = None
        self._last: Solution | None = None
        self._carried: Carried | None = None
        self._left_out: str | None = None
        self._solved_s = self._coloured_s = -math.inf

    def refresh(self, maneuver: Maneuver) -> Estimate | NoEstimate:
        """Estimate from the manoeuvre as far as it has been flown."""
        if maneuver.number != self._number:
            self._number, self._last, self._carried, self._coloured_s = maneuver.number, None, None, -math.inf
        now_s = float(maneuver.channels["q"].t[-1]) if maneuver.channels["q"] else -math.inf
        if self._carried is not None and now_s < self._solved_s + CARRY_S:
            found = self._carried.on(maneuver)
            if found is not None:
                return found
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
        self._carried = Carried(solution, prepared, found)
        return found
