"""From manoeuvres to estimates: what the rest of the program calls."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.prepare import prepare
from advisor.oem.solution import Method, Solution, solve

HIGH_CORRELATION = 0.9


def estimate(
    maneuver: Maneuver, aircraft: Aircraft, *, method: Method = "gauss-newton"
) -> Estimate | NoEstimate:
    """All eight parameters from one manoeuvre.

    Parameters
    ----------
    method : ``gauss-newton``, or ``nelder-mead`` for the paper's simplex (the same optimum, later).
    """
    return _estimate([maneuver], aircraft, method)


def estimate_jointly(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Estimate | NoEstimate:
    """One estimate over several manoeuvres: shared derivatives, own trim, initial states and biases."""
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    return _estimate(maneuvers, aircraft, "gauss-newton")


def _estimate(maneuvers: Sequence[Maneuver], aircraft: Aircraft, method: Method) -> Estimate | NoEstimate:
    problem = prepare(maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    solution = solve(problem, method=method)
    if isinstance(solution, NoEstimate):
        return solution
    return report(solution)


def report(solution: Solution, notes: tuple[str, ...] = ()) -> Estimate:
    """A solution as the rest of the program sees it."""
    airspeed = solution.problem.reference_airspeed_m_s
    if airspeed is None:
        speeds = [r.airspeed.y for r in solution.problem.records if r.airspeed is not None]
        airspeed = float(np.mean(np.concatenate(speeds))) if speeds else None
    return Estimate(
        theta=solution.theta,
        covariance_cr=solution.covariance_cr,
        covariance=solution.covariance,
        cost=solution.cost,
        fits=channel_fits(solution),
        iterations=solution.optimum.iterations,
        not_identifiable={},
        correlated=_correlated(solution.covariance_cr),
        condition=solution.influence.condition,
        airspeed_m_s=airspeed,
        notes=notes,
    )


def channel_fits(solution: Solution) -> tuple[dict[str, ChannelFit], ...]:
    """Measured against fitted, for every manoeuvre and output."""
    assembly = solution.assembly
    return tuple(
        {
            name: ChannelFit(
                name=name,
                t=assembly.t[rows],
                measured=assembly.z[rows],
                fitted=solution.fitted[rows],
                noise=float(solution.optimum.noise[OUTPUTS.index(name)]),
            )
            for name, rows in named.items()
        }
        for named in assembly.rows
    )


def _correlated(covariance: FloatArray) -> tuple[tuple[str, str, float], ...]:
    scale = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(scale, scale)
    return tuple(
        (PARAMETERS[i], PARAMETERS[j], float(correlation[i, j]))
        for i in range(len(PARAMETERS))
        for j in range(i + 1, len(PARAMETERS))
        if abs(correlation[i, j]) > HIGH_CORRELATION
    )
