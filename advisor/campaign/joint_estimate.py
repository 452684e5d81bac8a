"""The joint estimate over the accepted manoeuvres, sought when somebody asks for it.

The work of a joint estimate grows with its manoeuvres. No decision waits for it but the servo's lag. During
the flight the newest manoeuvres are estimated together, so that the two-hundredth verdict comes as soon as
the seventh. At the end all are, from the data alone, whatever was estimated on the way.
"""

from collections.abc import Sequence
from operator import is_

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate_jointly

NEWEST = 7
"""Accepted manoeuvres that are estimated together during the flight: a whole campaign of the paper. The seven
of ``logs/arduplane-calm.tlog`` tell the servo's lag to 5 %. Each further one takes some 0.1 s more of
processor time at every verdict."""


class Together:
    """Estimates manoeuvres jointly; the newest answer is kept.

    Parameters
    ----------
    aircraft
        As the crew gives it: what was learnt on the way does not enter.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._maneuvers: tuple[Maneuver, ...] = ()
        self._found: Estimate | None = None

    def estimate(self, maneuvers: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate over manoeuvres; None where there is none."""
        if len(maneuvers) != len(self._maneuvers) or not all(map(is_, maneuvers, self._maneuvers)):
            found = estimate_jointly(maneuvers, self._aircraft)
            self._maneuvers = tuple(maneuvers)
            self._found = found if isinstance(found, Estimate) else None
        return self._found
