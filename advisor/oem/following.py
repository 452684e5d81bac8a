"""The estimate of a manoeuvre while it is being flown, refreshed at every sample.

Each refresh is complete: all data so far, all parameters, corrected errors. It is quick because the search
begins where the last one ended, and because what changes slowly, the colour of the noise and whether the
angle of attack counts, is found out only now and then.
"""

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import report
from advisor.oem.prepare import prepare
from advisor.oem.solution import Solution, solve

COLOUR_EVERY = 100
"""Refreshes between two fits of the noise's colour, and between two checks of the angle of attack."""

CLOSE_ENOUGH = 1e-4
"""Promised change of log J per sample at which a refresh is done: hundredths of a standard deviation."""


class Follower:
    """Follows one manoeuvre after another; begins anew when the manoeuvre's number changes."""

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._number: int | None = None
        self._last: Solution | None = None
        self._left_out: str | None = None
        self._age = 0

    def refresh(self, maneuver: Maneuver) -> Estimate | NoEstimate:
        """Estimate from the manoeuvre as far as it has been flown."""
        if maneuver.number != self._number:
            self._number, self._last, self._age = maneuver.number, None, 0
        left_out = self._left_out if self._age % COLOUR_EVERY else None
        prepared = prepare([maneuver], self._aircraft, alpha_left_out=left_out)
        if isinstance(prepared, NoEstimate):
            return prepared
        self._left_out = prepared.alpha_left_out
        last = self._last
        if last is None or last.noise.colours.keys() != prepared.problem.records[0].outputs.keys():
            solution = solve(prepared.problem)
        else:
            solution = solve(
                prepared.problem,
                begin=(last.optimum.shared, last.optimum.local),
                flat=CLOSE_ENOUGH,
                noise=last.noise if self._age % COLOUR_EVERY else None,
            )
        self._age += 1
        self._last = solution if isinstance(solution, Solution) else None
        if isinstance(solution, NoEstimate):
            return solution
        return report(solution, prepared, self._aircraft, quick=True)
