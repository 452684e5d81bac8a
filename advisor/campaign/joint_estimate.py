"""The joint estimate of the accepted manoeuvres, computed on request.

The computing time of a joint estimate grows with the number of manoeuvres. Of all decisions, only the
decision on the servo's lag needs the joint estimate. During the flight only the newest manoeuvres are
estimated together, so that the two-hundredth verdict comes as soon as the seventh. At the end of the flight
all accepted manoeuvres are estimated together, from the data alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.course import same
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import Fit, fit_jointly
from advisor.oem.solution import Solution

NEWEST = 7
"""Number of newest accepted manoeuvres in the joint estimate during the flight: a whole campaign of the
paper. The seven manoeuvres of ``logs/arduplane-calm.tlog`` determine the servo's lag to 5 %. Each further
manoeuvre in the joint estimate takes some 0.1 s of processor time at every verdict."""


@dataclass(slots=True)
class _Joint:
    """One joint fit of manoeuvres, and its estimate if requested."""

    maneuvers: tuple[Maneuver, ...]
    tells_lag: bool
    """Whether the servo's lag is a parameter of the fit."""
    _fit: Fit | None
    """The joint fit; None if it failed."""
    _found: Estimate | None = None

    @classmethod
    def of(cls, maneuvers: Sequence[Maneuver], aircraft: Aircraft, earlier: "_Joint | None") -> "_Joint":
        """Fit several manoeuvres jointly. The search starts from the fit of earlier ones."""

        def near(plain: Solution) -> Solution | None:
            return None if earlier is None else earlier._near(maneuvers, plain)

        fit = fit_jointly(maneuvers, aircraft, near)
        if isinstance(fit, NoEstimate):
            return cls(tuple(maneuvers), False, None)
        return cls(tuple(maneuvers), fit.tells_lag, fit)

    def estimate(self) -> Estimate | None:
        """Return the estimate from the fit; None without a fit."""
        if self._found is None and self._fit is not None:
            self._found = self._fit.estimate()
            if len(self.maneuvers) > NEWEST:
                self._fit = None  # of hundreds of manoeuvres a fit is a hundred megabytes
        return self._found

    def _near(self, maneuvers: Sequence[Maneuver], plain: Solution) -> Solution | None:
        """Return the solution ``plain`` of manoeuvres, moved to the parameters of this fit.

        None where this fit has several hills, or commands that are held between their stamps.
        """
        if self._fit is None or not self._fit.fitted.one_hill:
            return None
        fitted, problem, local = self._fit.fitted, plain.problem, plain.optimum.local.copy()
        if any(record.held for record in fitted.solution.problem.records):
            return None
        for x, _ in fitted.identified:
            problem = x.write(problem, x.read(fitted.solution.problem))
        place = {id(maneuver): k for k, maneuver in enumerate(self.maneuvers)}
        for own, maneuver in zip(local, maneuvers, strict=True):
            if id(maneuver) in place:
                own[:] = fitted.solution.optimum.local[place[id(maneuver)]]
        optimum = plain.optimum._replace(shared=fitted.solution.optimum.shared, local=local)
        return replace(plain, problem=problem, optimum=optimum)


class Together:
    """Estimates manoeuvres jointly and keeps the newest joint estimate.

    Parameters
    ----------
    aircraft
        The crew's aircraft, without quantities identified during the flight.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._kept: _Joint | None = None
        self._group: tuple[tuple[Maneuver, ...], bool] = ((), False)

    def estimate(self, maneuvers: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate of manoeuvres; None without manoeuvres."""
        return self._of(maneuvers).estimate()

    def of_lag(self, maneuvers: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate of manoeuvres that determine the servo's lag; None if they do not.

        The joint fit shows whether the lag is determined; its estimate takes a quarter of the fit's time.
        """
        joint = self._of(maneuvers)
        return joint.estimate() if joint.tells_lag else None

    def of_lag_so_far(self, accepted: Sequence[Maneuver]) -> Estimate | None:
        """Return the joint estimate of the newest manoeuvres that determine the servo's lag; None if none do.

        Accepted manoeuvres are examined for a lag in groups of ``NEWEST``. If the newest whole group
        determines no lag, the result waits for the next group.
        """
        whole = len(accepted) - len(accepted) % NEWEST
        if whole and not self._group_tells_lag(accepted[whole - NEWEST : whole]):
            return None
        return self.of_lag(accepted[-NEWEST:])

    def _group_tells_lag(self, group: Sequence[Maneuver]) -> bool:
        if not same(self._group[0], group):
            self._group = tuple(group), self._of(group).tells_lag
        return self._group[1]

    def _of(self, maneuvers: Sequence[Maneuver]) -> _Joint:
        if self._kept is None or not same(self._kept.maneuvers, maneuvers):
            # More manoeuvres than in flight are estimated from the data alone.
            earlier = self._kept if len(maneuvers) <= NEWEST else None
            self._kept = _Joint.of(maneuvers, self._aircraft, earlier)
        return self._kept
