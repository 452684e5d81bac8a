"""From lateral manoeuvres to derivatives and modes: the function that the rest of the program calls."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.lateral import LATERAL, Trim
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import channel_fits
from advisor.oem.identifiability import correlated
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_instruments import nuisances_of
from advisor.oem.lateral_modes import Errors, lateral_modes
from advisor.oem.lateral_prepare import prepare_lateral
from advisor.oem.lateral_solution import LateralSolution, N, lateral_not_identifiable, solve_lateral
from advisor.oem.prediction import prediction_band


def estimate_lateral(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> LateralEstimate | NoEstimate:
    """Return the lateral derivatives from manoeuvres that share them, or why there is no estimate."""
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    problem = prepare_lateral(maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    solution = solve_lateral(problem, nuisances_of(problem, aircraft))
    return solution if isinstance(solution, NoEstimate) else _reported(solution)


def _reported(solution: LateralSolution) -> LateralEstimate:
    problem = solution.problem
    told = lateral_not_identifiable(solution)
    bound, covariance = solution.covariance_cr[:N, :N], solution.widened[:N, :N]
    estimate = Estimate(
        theta=solution.theta,
        covariance_cr=bound,
        covariance=covariance,
        cost=solution.cost,
        fits=channel_fits(solution.assembly, solution.optimum),
        iterations=solution.optimum.iterations,
        not_identifiable=told,
        correlated=correlated(bound, LATERAL.names.reported),
        condition=solution.influence.condition,
        airspeed_m_s=_airspeed(solution),
        servo_lag_s=max((servo.lag_s for servo in problem.servos.values()), default=0.0),
        prediction=prediction_band(solution.assembly, solution, solution.widened),
        names=LATERAL.names.reported,
    )
    errors = Errors(solution.covariance[:N, :N], solution.contributions[:, :N], solution.systematic[:N, :N])
    modes = lateral_modes(solution.theta, errors, _trim(solution))
    flown = tuple(name for name in LATERAL.inputs if problem.flies(name))
    scales = problem.reference_airspeed_m_s is not None
    return LateralEstimate(estimate, modes, solution.nuisances, flown, scales)


def _airspeed(solution: LateralSolution) -> float:
    """Return the speed of the derivatives, m/s: the reference, or the mean of a nearly constant speed."""
    problem = solution.problem
    return problem.reference_airspeed_m_s or float(np.mean([np.mean(r.airspeed.y) for r in problem.records]))


def _trim(solution: LateralSolution) -> Trim:
    records = solution.problem.records
    alpha, theta = (
        float(np.mean([np.mean(getattr(record, name).y) for record in records]))
        for name in ("alpha", "theta")
    )
    return Trim(_airspeed(solution), alpha, theta)
