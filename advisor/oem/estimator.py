"""From manoeuvres to estimates: what the rest of the program calls."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.between import widened_by_scatter
from advisor.oem.edges import large_steps, with_edges
from advisor.oem.efficient import efficient
from advisor.oem.estimate import ChannelFit, Estimate, InstrumentEstimate, NoEstimate
from advisor.oem.filter_error import filter_error, moving_air
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.identifiability import SUPPOSED_LAG_S, correlated, not_identifiable
from advisor.oem.instruments import (
    ACCELEROMETER_ARM,
    OF_ALPHA,
    SERVO_LAG,
    Instrument,
    Told,
    fit_instruments,
    told_at,
)
from advisor.oem.notes import notes
from advisor.oem.offset import with_offset
from advisor.oem.prediction import prediction_band
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.problem import Problem
from advisor.oem.solution import Method, Solution, evaluate, reported, search, solve
from advisor.oem.surface import Servo
from advisor.oem.turbulence import Turbulence
from advisor.oem.weighing import Weighing

N = len(PARAMETERS)
COLOURED = 0.5
"""Lag-1 correlation of the pitch rate's residual below which nothing drives the aircraft."""
UNEXPLAINED = 0.004
"""Share of the pitch rate's variance that moving air leaves unexplained at the least."""
CLEARLY = 10.0
"""Twice the log-likelihood by which another reading of the record must beat the usual one."""


def estimate(
    maneuver: Maneuver, aircraft: Aircraft, *, method: Method = "gauss-newton"
) -> Estimate | NoEstimate:
    """Return all eight parameters from one manoeuvre.

    Parameters
    ----------
    method : ``gauss-newton``, or ``nelder-mead`` for the paper's simplex (the same optimum, later). The
        simplex takes instruments and air as they are given.
    """
    return _estimate([maneuver], aircraft, method)


def estimate_jointly(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Estimate | NoEstimate:
    """Return one estimate over several manoeuvres: shared derivatives, own trim, initial states and
    biases."""
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    return _estimate(maneuvers, aircraft, "gauss-newton")


def _estimate(maneuvers: Sequence[Maneuver], aircraft: Aircraft, method: Method) -> Estimate | NoEstimate:
    """Return output error, unknown instruments, times of edges, then filter error where the air moves."""
    prepared = prepare(maneuvers, aircraft)
    if isinstance(prepared, NoEstimate):
        return prepared
    servo_known = aircraft.elevator.lag_s is not None
    solution = _solved(prepared.problem, method, servo_known)
    if isinstance(solution, NoEstimate):
        return solution
    if method != "gauss-newton":
        return report(solution, prepared, aircraft, lagged=_supposing_a_lag(solution, aircraft))
    fitted = fit_instruments(solution, unknown_instruments(prepared, aircraft))
    instruments = tuple(told.instrument for told in fitted.told)
    solution = fitted.solution
    if servo_known:
        solution = with_offset(solution)
    solution = with_edges(solution, solution.extra)
    lagged = None if SERVO_LAG in instruments else _supposing_a_lag(solution, aircraft)
    air = _air(solution, maneuvers, prepared)
    filtered = filter_error(solution, air.air, instruments) if air is not None else None
    told = fitted.told if filtered is None else told_at(filtered, instruments)
    return report(solution, prepared, aircraft, told=told, lagged=lagged, air=air, filtered=filtered)


def _air(solution: Solution, maneuvers: Sequence[Maneuver], prepared: Prepared) -> Turbulence | None:
    """Return the moving air and the noise of the instruments, where output error is out of its validity.

    Without an angle of attack the specific force carries every gust, so that its noise is always modelled.
    """
    if prepared.alpha_left_out:
        found = moving_air(solution, seen_by_alpha=False)
        return found if found.is_air else None
    fits = [fit["q"] for fit in channel_fits(solution)]
    if all(fit.lag1 < COLOURED or 1.0 - fit.r2 < UNEXPLAINED for fit in fits):
        return None
    derived = any(m.channels["alpha"].provenance == "derived" for m in maneuvers)
    found = moving_air(solution, seen_by_alpha=not derived)
    return found if found.present else None


def lag_is_unknown(aircraft: Aircraft) -> bool:
    """Return whether neither the crew nor the flight so far tells the servo's lag."""
    return aircraft.elevator.lag_s is None and aircraft.elevator.lag_found_s is None


def unknown_instruments(prepared: Prepared, aircraft: Aircraft) -> tuple[Instrument, ...]:
    """Return instruments whose parameters the aircraft file leaves open and the record may tell.

    A vane and an accelerometer at one place describe the motion of that place as well as those at the
    centre of gravity describe the aircraft's: one of the two places must be known to tell the other.
    """
    unknown = [SERVO_LAG] if lag_is_unknown(aircraft) else []
    measured = {name for record in prepared.problem.records for name in record.outputs}
    if {"alpha", "a_z"} <= measured:
        if aircraft.alpha.vane_arm_m is None:
            unknown += OF_ALPHA
        elif aircraft.accelerometer.arm_m is None:
            unknown.append(ACCELEROMETER_ARM)
    return tuple(unknown)


def _solved(problem: Problem, method: Method, servo_known: bool) -> Solution | NoEstimate:
    """Return the solution with the record read as the data clearly prefer.

    Eqs. (1)-(2) take the flight path as constant; gravity's part in α̇ as it turns is some 1e-4 rad/s and
    is left out where the data do not follow it. A command without large steps may be held between its
    stamps instead of linear; large steps get times of their own (``edges``). With a smooth command, holding
    is a delay of half an interval, which a servo that is not known takes along: it is then read as linear.
    """
    best = solve(problem, method=method)
    if any(record.normal_gravity is not None and record.airspeed is not None for record in problem.records):
        straight = tuple(replace(record, normal_gravity=None) for record in problem.records)
        best = _clearer(best, replace(problem, records=straight), method)
    if not servo_known or any(large_steps(record.elevator).interval for record in problem.records):
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
    told: Sequence[Told] = (),
    lagged: FloatArray | None = None,
    air: Turbulence | None = None,
    filtered: Solution | None = None,
    quick: bool = False,
) -> Estimate:
    """Return a solution as the rest of the program sees it.

    Parameters
    ----------
    told : instrument parameters that the data tell.
    lagged : (8,) the estimate had the servo a lag of ``SUPPOSED_LAG_S``, when the servo is unknown.
    air : what was found of moving air, where output error is out of its validity.
    filtered : filter error's solution, where the air was allowed for.
    quick : leave out what takes milliseconds: what missing channels cost, and the efficient estimate.
    """
    best = filtered or (solution if quick else efficient(solution))
    pulls = (filtered or solution).contributions[:, : len(best.covariance)]
    best = replace(best, covariance=widened_by_scatter(best.covariance, pulls))
    return Estimate(
        theta=best.theta,
        covariance_cr=best.covariance_cr[:N, :N],
        covariance=best.covariance[:N, :N],
        cost=solution.cost,
        fits=channel_fits(solution),
        iterations=solution.optimum.iterations,
        not_identifiable=not_identifiable(best if filtered else solution, lagged),
        correlated=correlated(best.covariance_cr[:N, :N]),
        condition=solution.influence.condition,
        airspeed_m_s=solution.problem.reference_airspeed_m_s or prepared.airspeed_m_s,
        notes=notes(solution, prepared, aircraft, told, lagged, best=best, priced=not quick),
        theta_of_lowest_cost=None if best.theta is solution.theta else solution.theta,
        instruments=tuple(InstrumentEstimate(x.instrument.name, x.value, x.std) for x in told),
        gust_rad=air.gust_angle if air is not None and air.present else None,
        filtered=filtered is not None,
        servo_lag_s=best.problem.servo.lag_s,
        prediction={} if quick else prediction_band(best),
    )


def _supposing_a_lag(solution: Solution, aircraft: Aircraft) -> FloatArray | None:
    """Return (8,) the estimate had an unknown servo a lag of ``SUPPOSED_LAG_S``; None where the servo is
    known."""
    if not lag_is_unknown(aircraft):
        return None
    servo = Servo(SUPPOSED_LAG_S, solution.problem.servo.delay_s)
    begin = (solution.optimum.shared, solution.optimum.local)
    _, moved = search(replace(solution.problem, servo=servo), begin=begin)
    return reported(moved.shared, moved.local) if moved.status == CONVERGED else None


def channel_fits(solution: Solution) -> tuple[dict[str, ChannelFit], ...]:
    """Return measured against fitted, for every manoeuvre and output."""
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
