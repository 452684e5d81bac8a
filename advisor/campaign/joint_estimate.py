"""The joint estimate of the accepted manoeuvres, computed on request, and the instruments that it identifies.

The computing time of a joint estimate grows with the number of manoeuvres. Of all decisions, only the
decision on the servo's lag needs the joint estimate. During the flight only the newest manoeuvres are
estimated together, so that the two-hundredth verdict comes as soon as the seventh. At the end of the flight
all accepted manoeuvres are estimated together, from the data alone.

Unknown instruments are estimated from all accepted manoeuvres together. Single estimates, verdicts and
criteria take the instruments as given, with their errors (``oem.known_instruments``). A servo's lag that the
crew leaves open must be known to a tenth.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.information import same
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import Fit, fit_jointly
from advisor.oem.instruments import knows_the_lag
from advisor.oem.known_instruments import FoundInstruments, found_of, with_found
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


CONTRADICTS = 3.0
"""Difference between two estimates of a derivative, in standard deviations, above which they contradict each
other."""
MUCH_SURER = 1.5
"""Ratio of standard deviations above which the more certain value replaces the value in use."""


def may_learn(aircraft: Aircraft, all_of_them: bool) -> bool:
    """Return whether a joint estimate may improve the values of the instruments.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with instruments that were identified earlier.
    all_of_them
        Whether the joint estimate uses all accepted manoeuvres. The newest manoeuvres alone do not improve
        these values.
    """
    return found_of(aircraft) is None or all_of_them


def learnt(
    aircraft: Aircraft, model: Estimate | None, *, one_power_on: bool = True, exactly: bool = False
) -> Aircraft:
    """Return the aircraft with the instruments from the joint estimate; unchanged without new values.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with instruments that were identified earlier.
    model
        Joint estimate over the accepted manoeuvres, made with the crew's aircraft.
    one_power_on
        Whether all these manoeuvres are of one power-on. The delay of the command differs between power-ons.
    exactly
        Take the newest values even if they differ by less than a standard deviation from those in use. True
        at the end of a log.
    """
    if model is None or model.found is None:
        return aircraft
    fresh = model.found if one_power_on else model.found.without("command_delay_s")
    if aircraft.elevator.lag_s is None and not knows_the_lag(model.instrument("servo_lag_s")):
        return aircraft
    used = found_of(aircraft)
    return aircraft if used is not None and _is_no_news(used, fresh, exactly) else with_found(aircraft, fresh)


def _is_no_news(used: FoundInstruments, found_instruments: FoundInstruments, exactly: bool) -> bool:
    """Return whether the values in use lie within the new standard deviations, and are similarly certain.

    ``exactly`` asks for the same values and errors.
    """
    if used.names != found_instruments.names:
        return False
    if exactly:
        names = ("values", "std", "covariance")
        return all(np.array_equal(getattr(used, x), getattr(found_instruments, x)) for x in names)
    near = np.abs(found_instruments.values - used.values) <= found_instruments.std
    return bool(np.all(near & (used.std <= MUCH_SURER * found_instruments.std)))


def of_another_power_on(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft before any manoeuvre of a power-on: with the delay of the command unknown."""
    given = found_of(aircraft)
    return aircraft if given is None else with_found(aircraft, given.without("command_delay_s"))


def lag_said(aircraft: Aircraft) -> str:
    """Return the event log's sentence on the lag that every estimate uses now; empty without a lag."""
    given, stated = found_of(aircraft), aircraft.elevator.lag_s
    lag_s = None if given is None else given.value("servo_lag_s")
    if given is None or lag_s is None:
        return ""
    std = float(given.std[given.names.index("servo_lag_s")])
    if stated is not None and abs(lag_s - stated) <= CONTRADICTS * std:
        return f"all manoeuvres together give a servo lag of {lag_s:.3f} s, as elevator.lag_s says"
    against = "" if stated is None else f", against {stated:.3f} s in elevator.lag_s,"
    return (
        f"the servo's lag is {lag_s:.3f} s{against} by all manoeuvres together; "
        "every estimate uses this lag now;"
        f" for the aircraft file: elevator: {{lag_s: {lag_s:.3f}}}"
    )
