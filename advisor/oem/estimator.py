"""From manoeuvres to estimates: what the rest of the program calls."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.edges import large_steps, with_edges
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.identifiability import SUPPOSED_LAG_S, correlated, not_identifiable
from advisor.oem.notes import notes
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.problem import Problem
from advisor.oem.servo_lag import Lag, by_lag, find_lag
from advisor.oem.solution import Method, Solution, solve
from advisor.oem.surface import Servo

N = len(PARAMETERS)
CLEARLY = 10.0
"""Twice the log-likelihood by which a held command must beat a linear one."""


def estimate(
    maneuver: Maneuver, aircraft: Aircraft, *, method: Method = "gauss-newton"
) -> Estimate | NoEstimate:
    """All eight parameters from one manoeuvre.

    Parameters
    ----------
    method : ``gauss-newton``, or ``nelder-mead`` for the paper's simplex (the same optimum, later).
    """
    prepared = prepare([maneuver], aircraft)
    if isinstance(prepared, NoEstimate):
        return prepared
    solution = _solved(prepared.problem, method)
    if isinstance(solution, NoEstimate):
        return solution
    solution = with_edges(solution) if method == "gauss-newton" else solution
    lagged = _supposing_a_lag(solution) if aircraft.elevator.lag_s is None else None
    return report(solution, prepared, aircraft, lagged=lagged)


def estimate_jointly(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Estimate | NoEstimate:
    """One estimate over several manoeuvres: shared derivatives, own trim, initial states and biases.

    When the aircraft file does not give the servo's lag, one is estimated too, and applied if the
    data tell it from zero.
    """
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    prepared = prepare(maneuvers, aircraft)
    if isinstance(prepared, NoEstimate):
        return prepared
    solution = _solved(prepared.problem)
    if isinstance(solution, NoEstimate):
        return solution
    lag = find_lag(solution.problem, solution) if aircraft.elevator.lag_s is None else None
    if lag is None:
        return report(with_edges(solution), prepared, aircraft)
    if lag.lag_s > 0.0:
        solution = with_edges(lag.solution, by_lag(lag.solution)[:, None])
        return report(solution, prepared, aircraft, lag=lag)
    solution = with_edges(solution)
    return report(solution, prepared, aircraft, lag=lag, lagged=_supposing_a_lag(solution))


def _solved(problem: Problem, method: Method = "gauss-newton") -> Solution | NoEstimate:
    """The solution with the command joined linearly between its stamps, or held if that is clearly better.

    Only a command without large steps is asked; those get times of their own (``edges``).
    """
    linear = solve(problem, method=method)
    if any(large_steps(record.elevator).interval for record in problem.records):
        return linear
    held = replace(problem, records=tuple(replace(record, held=True) for record in problem.records))
    other = solve(held, method=method)
    if isinstance(linear, NoEstimate) or isinstance(other, NoEstimate):
        return linear
    gain = linear.optimum.log_likelihood_cost - other.optimum.log_likelihood_cost
    return other if gain > CLEARLY else linear


def report(
    solution: Solution,
    prepared: Prepared,
    aircraft: Aircraft,
    *,
    lag: Lag | None = None,
    lagged: FloatArray | None = None,
) -> Estimate:
    """A solution as the rest of the program sees it.

    Parameters
    ----------
    lag : what the search for a servo lag found, when one was made.
    lagged : (8,) the estimate had the servo a lag of ``SUPPOSED_LAG_S``, when the servo is unknown.
    """
    return Estimate(
        theta=solution.theta,
        covariance_cr=solution.covariance_cr[:N, :N],
        covariance=solution.covariance[:N, :N],
        cost=solution.cost,
        fits=channel_fits(solution),
        iterations=solution.optimum.iterations,
        not_identifiable=not_identifiable(solution, lagged),
        correlated=correlated(solution.covariance_cr[:N, :N]),
        condition=solution.influence.condition,
        airspeed_m_s=solution.problem.reference_airspeed_m_s or prepared.airspeed_m_s,
        notes=notes(solution, prepared, aircraft, lag, lagged),
    )


def _supposing_a_lag(solution: Solution) -> FloatArray | None:
    """(8,) the estimate had the servo a lag of ``SUPPOSED_LAG_S``."""
    servo = Servo(SUPPOSED_LAG_S, solution.problem.servo.delay_s)
    begin = (solution.optimum.shared, solution.optimum.local)
    moved = solve(replace(solution.problem, servo=servo), begin=begin)
    return None if isinstance(moved, NoEstimate) else moved.theta


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
