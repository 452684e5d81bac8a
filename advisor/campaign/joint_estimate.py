"""The joint estimate over the accepted manoeuvres, computed on request.

The work of a joint estimate grows with the number of manoeuvres. Of all decisions, only the servo's lag needs
the joint estimate. During the flight only the newest manoeuvres are estimated together, so that the
two-hundredth verdict comes as soon as the seventh. At the end all accepted manoeuvres are estimated together,
from the data alone.
"""

from collections.abc import Sequence
from operator import is_

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import Fit, fit_jointly

NEWEST = 7
"""Number of newest accepted manoeuvres that are estimated together during the flight: a whole campaign of the
paper. The seven manoeuvres of ``logs/arduplane-calm.tlog`` give the servo's lag to 5 %. Each further
manoeuvre takes some 0.1 s more of processor time at every verdict."""


class Together:
    """Estimates manoeuvres jointly and keeps the newest result.

    Parameters
    ----------
    aircraft
        The crew's aircraft, without quantities identified during the flight.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._maneuvers: tuple[Maneuver, ...] = ()
        self._fit: Fit | None = None
        self._found: Estimate | None = None

    def estimate(self, maneuvers: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate over manoeuvres; None without manoeuvres."""
        self._take(maneuvers)
        if self._fit is not None:
            self._found, self._fit = self._fit.estimate(), None
        return self._found

    def of_lag(self, maneuvers: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate over manoeuvres that tell the servo's lag; None where they tell none.

        The fit knows that, and the estimate takes a quarter as long again.
        """
        self._take(maneuvers)
        return None if self._fit is not None and not self._fit.tells_lag else self.estimate(maneuvers)

    def _take(self, maneuvers: Sequence[Maneuver]) -> None:
        if len(maneuvers) != len(self._maneuvers) or not all(map(is_, maneuvers, self._maneuvers)):
            fit = fit_jointly(maneuvers, self._aircraft)
            self._maneuvers = tuple(maneuvers)
            self._fit, self._found = (None if isinstance(fit, NoEstimate) else fit), None
