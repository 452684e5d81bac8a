"""From manoeuvres to estimates: what the rest of the program calls."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.edges import large_steps, with_edges
from advisor.oem.efficient import efficient
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.identifiability import SUPPOSED_LAG_S, correlated, not_identifiable
from advisor.oem.notes import notes
from advisor.oem.offset import with_offset
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.problem import Problem
from advisor.oem.servo_lag import Lag, by_lag, find_lag
from advisor.oem.solution import Method, Solution, evaluate, reported, search, solve
from advisor.oem.surface import Servo
from advisor.oem.weighing import Weighing

N = len(PARAMETERS)
CLEARLY = 10.0
"""Twice the log-likelihood by which another reading of the record must beat the usual one."""


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
    servo_known = aircraft.elevator.lag_s is not None
    if method == "gauss-newton":
        solution = with_edges(with_offset(solution) if servo_known else solution)
    lagged = None if servo_known else _supposing_a_lag(solution)
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
        return report(with_edges(with_offset(solution)), prepared, aircraft)
    if lag.lag_s > 0.0:
        solution = with_edges(lag.solution, by_lag(lag.solution.problem, lag.solution.optimum)[:, None])
        return report(solution, prepared, aircraft, lag=lag)
    solution = with_edges(with_offset(solution))
    return report(solution, prepared, aircraft, lag=lag, lagged=_supposing_a_lag(solution))


def _solved(problem: Problem, method: Method = "gauss-newton") -> Solution | NoEstimate:
    """The solution with the record read as the data clearly prefer.

    Eqs. (1)-(2) take the flight path as constant; gravity's part in α̇ as it turns is some 1e-4 rad/s and is
    left out where the data do not follow it. A command without large steps may be held between its
    stamps instead of linear; large steps get times of their own (``edges``).
    """
    best = solve(problem, method=method)
    if any(record.path is not None and record.airspeed is not None for record in problem.records):
        straight = tuple(replace(record, path=None) for record in problem.records)
        best = _clearer(best, replace(problem, records=straight), method)
    if any(large_steps(record.elevator).interval for record in problem.records):
        return best
    records = problem.records if isinstance(best, NoEstimate) else best.problem.records
    held = tuple(replace(record, held=True) for record in records)
    return _clearer(best, replace(problem, records=held), method)


def _clearer(best: Solution | NoEstimate, other: Problem, method: Method) -> Solution | NoEstimate:
    """``best``, unless the other reading of the same data explains them clearly better.

    Better both as output error weighs them and as coloured noise does: where the model does not hold, as with
    a servo unknown, the two may contradict each other.
    """
    if isinstance(best, NoEstimate):
        return best
    begin = (best.optimum.shared, best.optimum.local) if method == "gauss-newton" else None
    assembly, optimum = search(other, method=method, begin=begin)
    gain = best.optimum.log_likelihood_cost - optimum.log_likelihood_cost
    if optimum.status != CONVERGED or not gain > CLEARLY:
        return best
    weighing = Weighing.by(best.noise, best.assembly)
    misfit = weighing.misfit(best.residual, best.sensitivities)
    if misfit - weighing.misfit(assembly.z - optimum.fitted, optimum.sensitivities) <= CLEARLY:
        return best
    rival = evaluate(other, assembly, optimum)
    return best if isinstance(rival, NoEstimate) else rival


def report(
    solution: Solution,
    prepared: Prepared,
    aircraft: Aircraft,
    *,
    lag: Lag | None = None,
    lagged: FloatArray | None = None,
    quick: bool = False,
) -> Estimate:
    """A solution as the rest of the program sees it.

    Parameters
    ----------
    lag : what the search for a servo lag found, when one was made.
    lagged : (8,) the estimate had the servo a lag of ``SUPPOSED_LAG_S``, when the servo is unknown.
    quick : leave out what takes milliseconds: what missing channels cost, and the efficient estimate.
    """
    best = solution if quick else efficient(solution)
    return Estimate(
        theta=best.theta,
        covariance_cr=best.covariance_cr[:N, :N],
        covariance=best.covariance[:N, :N],
        cost=solution.cost,
        fits=channel_fits(solution),
        iterations=solution.optimum.iterations,
        not_identifiable=not_identifiable(solution, lagged),
        correlated=correlated(solution.covariance_cr[:N, :N]),
        condition=solution.influence.condition,
        airspeed_m_s=solution.problem.reference_airspeed_m_s or prepared.airspeed_m_s,
        notes=notes(solution, prepared, aircraft, lag, lagged, best=best, priced=not quick),
        theta_of_lowest_cost=None if best is solution else solution.theta,
    )


def _supposing_a_lag(solution: Solution) -> FloatArray | None:
    """(8,) the estimate had the servo a lag of ``SUPPOSED_LAG_S``."""
    servo = Servo(SUPPOSED_LAG_S, solution.problem.servo.delay_s)
    begin = (solution.optimum.shared, solution.optimum.local)
    _, moved = search(replace(solution.problem, servo=servo), begin=begin)
    return reported(moved.shared, moved.local) if moved.status == CONVERGED else None


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
