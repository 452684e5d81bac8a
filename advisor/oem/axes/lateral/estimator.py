"""Estimation of derivatives and modes from lateral manoeuvres, as called by other packages.

The modes have 95 % intervals by the delta method.
Let λ be a simple eigenvalue of A with right and left eigenvectors v and w. A change dA of the matrix changes
it by dλ = wᵀ·dA·v/(wᵀ·v) (Wilkinson, *The Algebraic Eigenvalue Problem*, 1965, ch. 2). The Dutch roll has the
frequency ω = |λ| and the damping ζ = -Re λ/ω, and the roll mode has the time constant -1/λ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.oem.axes.lateral.estimate import LateralEstimate, LateralModes
from advisor.oem.axes.lateral.instruments import nuisances_of
from advisor.oem.axes.lateral.motion import with_sideslip
from advisor.oem.axes.lateral.prepare import prepare_lateral
from advisor.oem.axes.lateral.solution import Near, Searched, lateral_not_identifiable, search_lateral
from advisor.oem.estimate import NoEstimate
from advisor.oem.estimator import channel_fits
from advisor.oem.flying_qualities import Quality
from advisor.oem.gained import told, without_term, without_terms
from advisor.oem.identifiability import correlated
from advisor.oem.prediction import prediction_band
from advisor.oem.scatter_between import widened_by_scatter
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray

N = len(LATERAL.shared)
_STATES = len(LATERAL.states)


class Errors(NamedTuple):
    """Errors of the lateral derivatives, for the error of a mode."""

    covariance: FloatArray
    """Shape (15, 15): covariance from the noise within the manoeuvres."""
    contributions: FloatArray
    """Shape (m, 15): contribution of each manoeuvre to the derivatives."""
    systematic: FloatArray = np.zeros((len(LATERAL.shared), len(LATERAL.shared)))
    """Shape (15, 15): covariance from dynamics that the model lacks."""

    def std(self, slope: FloatArray) -> float:
        """Return the standard deviation of a quantity with gradient ``slope`` (15,) over the derivatives.

        The variance includes the scatter of the quantity between the manoeuvres. If one manoeuvre alone
        determines the quantity, that scatter is zero. The variance therefore grows at least by the mean
        growth of the derivatives' variances (Birge, *Phys. Rev.* 40, 1932). A factor for each derivative
        would break the correlations that make a mode more certain than its derivatives.
        """
        within = slope @ self.covariance @ slope
        own = widened_by_scatter(np.array([[within]]), (self.contributions @ slope)[:, None])[0, 0]
        common = slope @ self.systematic @ slope
        return float((max(own, within * self._growth, 0.0) + common) ** 0.5)

    @property
    def _growth(self) -> float:
        """Mean factor on the derivatives' variances due to the scatter between manoeuvres."""
        stated = np.diag(self.covariance)
        moving = stated > 0.0
        widened = np.diag(widened_by_scatter(self.covariance, self.contributions))
        return float(np.mean(widened[moving] / stated[moving])) if moving.any() else 1.0


def lateral_modes(theta: FloatArray, errors: Errors, trim: Trim) -> LateralModes:
    """Return the modes at the trim for derivatives ``theta`` (15,), with their errors."""
    a = state_matrix(theta, trim)
    modes = modes_of(a)
    omega = zeta = roll = spiral = None
    left_out: dict[str, str] = {}
    if modes.dutch_roll is None:
        left_out["dutch_roll"] = "the aircraft has no oscillation in yaw at these values"
    else:
        value = modes.dutch_roll
        slope = _slope(a, value)
        size = abs(value)
        by_size = (value.conjugate() * slope).real / size
        by_damping = -slope.real / size + value.real * by_size / size**2
        omega = _quality(size, by_size, errors)
        zeta = _quality(-value.real / size, by_damping, errors)
    if modes.roll is None or modes.spiral is None:
        left_out["roll"] = left_out["spiral"] = "roll and spiral oscillate together at these values"
    else:
        roll = _quality(-1.0 / modes.roll, _slope(a, modes.roll).real / modes.roll**2, errors)
        spiral = _quality(modes.spiral, _slope(a, modes.spiral).real, errors)
    return LateralModes(omega, zeta, roll, spiral, left_out)


def _slope(a: FloatArray, value: complex) -> np.ndarray:
    """Return the gradient of an eigenvalue of ``a`` over the 15 derivatives."""
    values, right = np.linalg.eig(a)
    k = int(np.argmin(np.abs(values - value)))
    left = np.linalg.inv(right)[k]
    moved = np.zeros(len(LATERAL.shared), np.complex128)
    for j, (row, column, _) in enumerate(LATERAL.place[: len(LATERAL.shared)]):
        if column < _STATES:
            moved[j] = left[row] * right[column, k]
    return moved


def _quality(value: float, slope: FloatArray, errors: Errors) -> Quality:
    return Quality(float(value), errors.std(slope))


class LateralFit(NamedTuple):
    """Solution of manoeuvres that share their derivatives."""

    maneuvers: Sequence[Maneuver]
    aircraft: Aircraft
    searched: Searched

    @property
    def estimate(self) -> LateralEstimate:
        """Derivatives, modes and errors as reported."""
        solution = self.searched.solution
        # Innovations have another colour than residuals, so that the fits before unknown forces are compared.
        terms = told(self.aircraft.estimation.added, solution.nuisances, self.searched.still, self._without)
        return replace(_reported(solution), terms=terms)

    def _without(self, term: str) -> Solution | None:
        """Return the solution without one of the user's terms; None without such a solution."""
        other = fit_lateral(self.maneuvers, without_term(self.aircraft, term))
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

    newest: LateralFit | None = None


def estimate_lateral(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, search: JointSearch | None = None
) -> LateralEstimate | NoEstimate:
    """Return the lateral derivatives of manoeuvres that share them, or the reason for a missing estimate.

    Parameters
    ----------
    search
        Searches of earlier manoeuvres of the aircraft, which this one continues. None: the search begins
        with a regression.
    """
    fit = fit_lateral(maneuvers, aircraft, None if search is None else search.newest)
    if isinstance(fit, NoEstimate):
        return fit
    if search is not None:
        search.newest = fit
    return fit.estimate


def fit_lateral(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, earlier: LateralFit | None = None
) -> LateralFit | NoEstimate:
    """Return the solution of manoeuvres that share their derivatives, or the reason for a missing one.

    Parameters
    ----------
    earlier
        Fit of earlier manoeuvres of one aircraft, which this search continues.
    """
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    problem = prepare_lateral(maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    near = None if earlier is None else earlier.near(maneuvers)
    if problem.needs_beta:
        # A sideslip that no vane measures is that of the model without the terms.
        plain = fit_lateral(maneuvers, without_terms(aircraft))
        if isinstance(plain, NoEstimate):
            return plain
        problem = with_sideslip(problem, plain.searched.solution)
    searched = search_lateral(problem, nuisances_of(problem, aircraft), near)
    return searched if isinstance(searched, NoEstimate) else LateralFit(maneuvers, aircraft, searched)


def _reported(solution: Solution) -> LateralEstimate:
    problem, covariance = solution.problem, solution.widened[:N, :N]
    bound, common = solution.covariance_cr[:N, :N], covariance - solution.scattered[:N, :N]
    errors = Errors(solution.covariance[:N, :N], solution.contributions[:, :N], common)
    return LateralEstimate(
        theta=solution.theta,
        covariance_cr=bound,
        covariance=covariance,
        cost=solution.cost,
        fits=channel_fits(solution.assembly, solution.optimum),
        iterations=solution.optimum.iterations,
        not_identifiable=lateral_not_identifiable(solution),
        correlated=correlated(bound, LATERAL.names.reported),
        condition=solution.influence.condition,
        airspeed_m_s=_airspeed(solution),
        servo_lag_s=max((servo.lag_s for servo in problem.servos.values()), default=0.0),
        prediction=prediction_band(solution.assembly, solution, solution.widened),
        names=LATERAL.names.reported,
        modes=lateral_modes(solution.theta, errors, _trim(solution)),
        nuisances={name: x for name, x in solution.nuisances.items() if name not in problem.terms},
        fixed=tuple(problem.fixed),
        flown=tuple(name for name in LATERAL.inputs if problem.flies(name)),
        scales_with_speed=problem.reference_airspeed_m_s is not None,
    )


def _airspeed(solution: Solution) -> float:
    """Return the air speed of the derivatives, m/s: the reference speed, or the mean of a nearly constant
    speed."""
    problem = solution.problem
    return problem.reference_airspeed_m_s or float(np.mean([np.mean(r.airspeed.y) for r in problem.records]))


def _trim(solution: Solution) -> Trim:
    records = solution.problem.records
    alpha, theta = (
        float(np.mean([np.mean(getattr(record, name).y) for record in records]))
        for name in ("alpha", "theta")
    )
    return Trim(_airspeed(solution), alpha, theta)
