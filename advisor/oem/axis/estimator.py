"""Estimation of derivatives and modes along an axis, as called by other packages.

The modes of the motion have 95 % intervals by the delta method, from the slopes in the table of the axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axis import Around, Axis
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.motion import AxisMotion, with_hidden
from advisor.oem.axis.parameter import parameters_of
from advisor.oem.axis.prepare import prepare
from advisor.oem.axis.search import Near, Searched, not_identifiable, search
from advisor.oem.axis.start import starting_point
from advisor.oem.descent import descended
from advisor.oem.estimate import ChannelFit, NoEstimate
from advisor.oem.estimator import channel_fits
from advisor.oem.flying_qualities import Quality
from advisor.oem.identifiability import correlated, told, without_term, without_terms
from advisor.oem.prediction import prediction_band
from advisor.oem.prior import Priors
from advisor.oem.scatter_between import widened_by_scatter
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray

HELD = 1e-6
"""Numerical: standard deviation of the given derivatives in the refit of a prediction, SI."""


class Errors(NamedTuple):
    """Errors of the derivatives, for the error of a mode."""

    covariance: FloatArray
    """Shape (s, s): covariance from the noise within the manoeuvres."""
    contributions: FloatArray
    """Shape (m, s): contribution of each manoeuvre to the derivatives."""
    systematic: FloatArray | None = None
    """Shape (s, s): covariance from dynamics that the model lacks."""

    def std(self, slope: FloatArray) -> float:
        """Return the standard deviation of a quantity with gradient ``slope`` (s,) over the derivatives.

        The variance includes the scatter of the quantity between the manoeuvres. If one manoeuvre alone
        determines the quantity, that scatter is zero. The variance therefore grows at least by the mean
        growth of the derivatives' variances (Birge, *Phys. Rev.* 40, 1932). A factor for each derivative
        would break the correlations that make a mode more certain than its derivatives.
        """
        within = slope @ self.covariance @ slope
        own = widened_by_scatter(np.array([[within]]), (self.contributions @ slope)[:, None])[0, 0]
        common = 0.0 if self.systematic is None else slope @ self.systematic @ slope
        return float((max(own, within * self._growth, 0.0) + common) ** 0.5)

    @property
    def _growth(self) -> float:
        """Mean factor on the derivatives' variances due to the scatter between manoeuvres."""
        stated = np.diag(self.covariance)
        moving = stated > 0.0
        widened = np.diag(widened_by_scatter(self.covariance, self.contributions))
        return float(np.mean(widened[moving] / stated[moving])) if moving.any() else 1.0


class AxisFit(NamedTuple):
    """Solution of manoeuvres that share their derivatives."""

    axis: Axis
    maneuvers: Sequence[Maneuver]
    aircraft: Aircraft
    searched: Searched

    @property
    def estimate(self) -> AxisEstimate:
        """Derivatives, modes and errors as reported."""
        solution = self.searched.solution
        # Innovations have another colour than residuals, so that the fits before unknown forces are compared.
        terms = told(self.aircraft.estimation.added, solution.nuisances, self.searched.still, self._without)
        return replace(_reported(solution), terms=terms)

    def _without(self, term: str) -> Solution | None:
        """Return the solution without one of the user's terms; None without such a solution."""
        other = fit_axis(self.axis, self.maneuvers, without_term(self.aircraft, term))
        return None if isinstance(other, NoEstimate) else other.searched.still

    def near(self, maneuvers: Sequence[Maneuver]) -> Near:
        """Return the search as the start for other manoeuvres."""
        place = {id(maneuver): k for k, maneuver in enumerate(self.maneuvers)}
        return Near(self.searched, [place.get(id(maneuver)) for maneuver in maneuvers])


@dataclass(slots=True)
class JointSearch:
    """Joint searches of a campaign, each of which continues the one before.

    A further manoeuvre then takes one fit, not three.
    """

    newest: AxisFit | None = None


def estimate_axis(
    axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft, joint: JointSearch | None = None
) -> AxisEstimate | NoEstimate:
    """Return the derivatives of manoeuvres that share them, or the reason for a missing estimate.

    Parameters
    ----------
    joint
        Searches of earlier manoeuvres of the aircraft, which this one continues. None: the search begins
        with a regression.
    """
    made = fit_axis(axis, maneuvers, aircraft, None if joint is None else joint.newest)
    if isinstance(made, NoEstimate):
        return made
    if joint is not None:
        joint.newest = made
    return made.estimate


def fit_axis(
    axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft, earlier: AxisFit | None = None
) -> AxisFit | NoEstimate:
    """Return the solution of manoeuvres that share their derivatives, or the reason for a missing one.

    Parameters
    ----------
    earlier
        Fit of earlier manoeuvres of one aircraft, which this search continues.
    """
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    problem = prepare(axis, maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    near = None if earlier is None else earlier.near(maneuvers)
    if problem.needs_hidden:
        # A sideslip that no vane measures is that of the model without the terms.
        plain = fit_axis(axis, maneuvers, without_terms(aircraft))
        if isinstance(plain, NoEstimate):
            return plain
        problem = with_hidden(problem, plain.searched.solution)
    searched = search(problem, parameters_of(problem, aircraft), near)
    return searched if isinstance(searched, NoEstimate) else AxisFit(axis, maneuvers, aircraft, searched)


def modes_of(
    axis: Axis, theta: FloatArray, errors: Errors, around: Around
) -> tuple[dict[str, Quality], Mapping[str, str]]:
    """Return the quantities of the modes with their errors, and the reason for each mode without them."""
    if axis.qualities is None:
        return {}, {}
    made, left_out = axis.qualities(theta, around)
    return {name: Quality(float(m.value), errors.std(m.slope)) for name, m in made.items()}, left_out


def _reported(solution: Solution) -> AxisEstimate:
    problem, axis = solution.problem, solution.problem.axis
    n = len(axis.shared)
    covariance, bound = solution.widened[:n, :n], solution.covariance_cr[:n, :n]
    common = covariance - solution.scattered[:n, :n]
    errors = Errors(solution.covariance[:n, :n], solution.contributions[:, :n], common)
    airspeed = problem.reference_airspeed_m_s or problem.mean_airspeed_m_s
    trims = [problem.trim(m) for m in range(len(problem.records))]
    trim = {name: float(np.mean([each[name] for each in trims])) for name in trims[0]}
    modes, left_out = modes_of(axis, solution.theta, errors, {**trim, "airspeed": airspeed})
    flown = tuple(name for name in axis.inputs if problem.flies(name))
    still = {*axis.inputs} - {*flown}
    return AxisEstimate(
        theta=solution.theta,
        covariance_cr=bound,
        covariance=covariance,
        common=np.zeros((n, n)),
        cost=solution.cost,
        fits=channel_fits(solution.assembly, solution.optimum),
        iterations=solution.optimum.iterations,
        not_identifiable=not_identifiable(solution),
        correlated=correlated(bound, axis.names.reported),
        condition=solution.influence.condition,
        airspeed_m_s=airspeed,
        servo_lag_s=max((problem.at((name, "lag_s")) for name in axis.inputs), default=0.0),
        prediction=prediction_band(solution.assembly, solution, solution.widened),
        names=axis.names.reported,
        modes=modes,
        modes_left_out=left_out,
        nuisances={name: x for name, x in solution.nuisances.items() if name not in problem.terms},
        fixed=tuple(problem.fixed),
        flown=flown,
        of_still=tuple(term.name for term in axis.shared if term.factor in still),
        scales_with_speed=problem.reference_airspeed_m_s is not None,
    )


def predicted(
    axis: Axis,
    maneuver: Maneuver,
    model: AxisEstimate,
    aircraft: Aircraft,
    theta: FloatArray | None = None,
) -> Mapping[str, ChannelFit] | NoEstimate:
    """Return measured and predicted values of a manoeuvre, by the output's name.

    Trims, initial states and biases are the manoeuvre's own; nothing else is fitted to it.

    Parameters
    ----------
    model
        Estimate from other manoeuvres, including the instruments.
    theta
        Derivatives (s,) at the model's speed; None for the model's own derivatives.
    """
    problem = prepare(axis, [maneuver], aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    (record,) = problem.records
    kept = {name: signal for name, signal in record.outputs.items() if name in model.fits[0]}
    problem = replace(problem, records=(replace(record, outputs=kept),))
    if model.scales_with_speed:
        problem = replace(problem, reference_airspeed_m_s=model.airspeed_m_s)
    for x in parameters_of(problem, aircraft):
        if x.name in model.nuisances:
            problem = x.write(problem, model.nuisances[x.name][0])
    chosen = model.theta if theta is None else theta
    local = starting_point(problem)[1]
    local[0, : len(axis.constants)] = 0.0
    held = Priors(chosen, np.full(len(chosen), HELD))
    made = descended(AxisMotion(axis), problem, (), held, (chosen, local))
    return made if isinstance(made, NoEstimate) else channel_fits(made.assembly, made.optimum)[0]
