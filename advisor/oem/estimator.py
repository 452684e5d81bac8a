"""Estimation of parameters from manoeuvres, as called by other packages, with the true edges of the command.

A step between two stamps is drawn as a ramp over the interval, equivalent to a step in its middle. The true
time of a step lies anywhere in the interval, and at the later stamp for a held digital command. An error of
half an interval is a false delay of many standard deviations in a joint estimate. Each large step therefore
gets its own time, estimated with all other parameters, if the data require it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.input_response import N_READING, InputChange
from advisor.oem.covariance import Weighing
from advisor.oem.driven_motion.estimate import Driven, driven, driven_without_alpha
from advisor.oem.estimate import ChannelFit, Estimate, InstrumentEstimate, NoEstimate
from advisor.oem.extra import Extra, Prior
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.identifiability import correlated, not_identifiable, told, without_term
from advisor.oem.instrument_columns import input_columns, stacked
from advisor.oem.instrument_fit import PITCH, Identified, InstrumentFit, fit_instruments, refreshed
from advisor.oem.instruments import BY_NAME, COMMAND_DELAY, Instrument, knows_the_lag, unknown_instruments
from advisor.oem.known_instruments import FoundInstruments, found_of
from advisor.oem.notes import notes
from advisor.oem.prediction import prediction_band
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.prior import Priors, about_zero, precision
from advisor.oem.problem import Assembly, OutputErrorProblem, Record
from advisor.oem.rows import Laid, Signal
from advisor.oem.solution import Solution, evaluate, search, solve
from advisor.process.arrays import FloatArray

LARGE = 0.25
"""Least share of the command's range that a large step covers within one interval."""
ISOLATED = 0.3
"""Largest change in the neighbouring intervals, as a share of the step, for an isolated step."""
WIDTH_S = 1e-4
"""Duration of a sharpened step, s."""
ROUNDS = 2
CHANCE = 1e-3
"""Largest probability of a likelihood gain by chance with which steps are sharpened."""
GAIN_UPRIGHT = 3.0
"""Least gain in twice the log likelihood of vertical steps in the middle of their intervals. A ramp and a
step in its middle look alike but give different M_δe."""
MOST_MANEUVERS = 20
CLOSE_ENOUGH = 1e-9
"""Promised change of log J per sample at which an intermediate search ends."""


@dataclass(frozen=True, slots=True)
class Edges:
    """Large steps of one record's command, and their times."""

    interval: tuple[int, ...]
    """Index of the stamp before each step."""
    stamps: FloatArray
    """Shape (2, k): stamps before and after each step, s."""
    time: FloatArray
    """Shape (k,): time of each step, between its stamps, s."""


def large_steps(command: Signal) -> Edges:
    """Return the isolated large steps of a command, each placed in the middle between two stamps."""
    change = np.abs(np.diff(command.y))
    next_to_it = np.maximum(np.append(change[1:], 0.0), np.append(0.0, change[:-1]))
    span = float(np.ptp(command.y))
    interval = tuple(
        int(i) for i in np.flatnonzero((change > LARGE * span) & (next_to_it < ISOLATED * change))
    )
    stamps = np.array([command.t[: len(change)], command.t[1:]])[:, list(interval)]
    return Edges(interval, stamps, stamps.mean(axis=0))


def sharpened(command: Signal, edges: Edges) -> Signal:
    """Return the command with vertical large steps at the given times."""
    t, y = list(command.t), list(command.y)
    for i, when in sorted(zip(edges.interval, edges.time, strict=True), reverse=True):
        t[i + 1 : i + 1] = [when - WIDTH_S / 2.0, when + WIDTH_S / 2.0]
        y[i + 1 : i + 1] = [command.y[i], command.y[i + 1]]
    return Signal(np.array(t), np.array(y))


def with_edges(plain: Solution) -> Solution:
    """Return the solution with a time for every large step; ``plain`` if the gain is too small.

    The additional parameters of ``plain`` keep their values and errors, and the step times follow them. A
    step is equally likely everywhere between its two stamps."""
    records = plain.problem.records
    edges = [large_steps(record.elevator) for record in records]
    count = sum(len(e.interval) for e in edges)
    if count == 0 or len(records) > MOST_MANEUVERS or any(record.held for record in records):
        return plain
    own = plain.extra or Extra.none(len(plain.fitted))
    near, problem, assembly, optimum = plain.optimum, plain.problem, plain.assembly, plain.optimum
    weighing = Weighing.by(plain.noise.colours, plain.assembly)
    before = weighing.misfit(plain.residual, plain.sensitivities)
    extra, gain, upright = own, 0.0, 0.0
    for round_ in range(ROUNDS + 1):
        problem = _edged(plain.problem, edges, records)
        assembly, optimum = search(problem, begin=(near.shared, near.local), flat=CLOSE_ENOUGH)
        if optimum.status != CONVERGED:
            return plain
        near = optimum
        residual, g = assembly.z - optimum.fitted, optimum.sensitivities
        gain = before - weighing.misfit(residual, g)
        if round_ == 0:
            upright = gain
        columns = _by_edges(problem, assembly, optimum, edges)
        extra = own.joined(_within_intervals(edges, columns))
        if round_ == ROUNDS:
            break
        effect = weighing.influence(g, extra)
        if effect is None:
            return plain
        edges = _moved(edges, effect.step(residual, extra)[len(PARAMETERS) + len(own) :])
    if gain < chdtri(count, CHANCE) and upright < GAIN_UPRIGHT:
        return plain
    final = evaluate(problem, assembly, optimum, extra, kept=len(own))
    return replace(final, modes=plain.modes, alike=plain.alike) if isinstance(final, Solution) else plain


def _edged(
    problem: OutputErrorProblem, edges: Sequence[Edges], records: Sequence[Record]
) -> OutputErrorProblem:
    """Return the problem with the commands of ``records`` sharpened."""
    return replace(
        problem,
        records=tuple(
            replace(record, elevator=sharpened(record.elevator, e))
            for record, e in zip(records, edges, strict=True)
        ),
    )


def _within_intervals(edges: Sequence[Edges], columns: FloatArray) -> Extra:
    """Return the step times as parameters, with a uniform prior over their intervals."""
    first, last = np.concatenate([e.stamps for e in edges], axis=1)
    time = np.concatenate([e.time for e in edges])
    priors = [Prior((a + b) / 2.0, (b - a) / np.sqrt(12.0)) for a, b in zip(first, last, strict=True)]
    return Extra.at(columns, time, priors)


def _moved(edges: Sequence[Edges], steps: FloatArray) -> list[Edges]:
    """Return the steps with moved times, each within its interval."""
    ends = np.cumsum([len(e.interval) for e in edges])
    return [
        replace(e, time=np.clip(e.time + by, e.stamps[0] + WIDTH_S, e.stamps[1] - WIDTH_S))
        for e, by in zip(edges, np.split(steps, ends[:-1]), strict=True)
    ]


def _by_edges(
    problem: OutputErrorProblem, assembly: Assembly, optimum: Optimum, edges: Sequence[Edges]
) -> FloatArray:
    """Return the derivatives of the outputs by the step times, shape (N, k), manoeuvre by manoeuvre.

    The j-th steps of all manoeuvres are moved together, because each affects its own manoeuvre only.
    """
    counts = [len(e.interval) for e in edges]
    most = max(counts)

    def changes(m: int, record: Record, t: FloatArray) -> InputChange:
        # Two samples that draw an edge upright stand behind those of each edge before.
        upright = [i + 1 + 2 * j for j, i in enumerate(edges[m].interval)]
        late = [
            problem.servo.changes(record.elevator.t, record.elevator.y, t, intervals=upright[j : j + 1])
            for j in range(most)
        ]
        return InputChange(*(rows[:, ::2] for rows in stacked(late, axis=1)))

    together = input_columns(problem, assembly, optimum.shared, optimum.local, changes)[:, N_READING:]
    columns = np.zeros((len(assembly.z), sum(counts)))
    first = np.cumsum([0, *counts])
    for m, count in enumerate(counts):
        mine = assembly.owner == m
        columns[mine, first[m] : first[m + 1]] = together[mine, :count]
    return columns


N = len(PARAMETERS)
COLOURED = 0.5
"""Least lag-1 correlation of the pitch rate's residual that suggests moving air. Below this correlation the
air is still."""
UNEXPLAINED = 0.004
"""Least unexplained share of the pitch rate's variance that suggests moving air."""
CLEARLY = 10.0
"""Least gain in twice the log likelihood by which an alternative model of the record is preferred."""


def estimate(maneuver: Maneuver, aircraft: Aircraft) -> Estimate | NoEstimate:
    """Return all eight parameters from one manoeuvre, or the reason for a missing estimate."""
    return estimate_jointly([maneuver], aircraft)


def estimate_jointly(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Estimate | NoEstimate:
    """Return one estimate over several manoeuvres, with shared derivatives and separate nuisance
    parameters."""
    fit = fit_jointly(maneuvers, aircraft)
    return fit if isinstance(fit, NoEstimate) else fit.estimate()


def fit_jointly(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    near: Callable[[Solution], Solution | None] = lambda _: None,
) -> "Fit | NoEstimate":
    """Return the fit on which the estimate over several manoeuvres is based.

    ``near`` returns a start on the one hill of earlier manoeuvres, from the solution without instruments.
    """
    if not maneuvers:
        return NoEstimate("no_maneuver", "There is no manoeuvre to estimate from.")
    prepared = prepare(maneuvers, aircraft)
    if isinstance(prepared, NoEstimate):
        return prepared
    plain = _solved(prepared.problem)
    if isinstance(plain, NoEstimate):
        return plain
    return Fit(maneuvers, aircraft, prepared, plain, _with_instruments(plain, aircraft, near(plain)))


@dataclass(frozen=True, slots=True)
class Fit:
    """Output-error fit with the log's instruments, before corrections for step times and moving air."""

    maneuvers: Sequence[Maneuver]
    aircraft: Aircraft
    prepared: Prepared
    plain: Solution
    """Solution without instrument parameters."""
    fitted: InstrumentFit

    @property
    def tells_lag(self) -> bool:
        """Whether the manoeuvres determine the servo's lag well enough for all other estimates."""
        return any(knows_the_lag(x.found) for x in self.fitted.identified)

    def estimate(self) -> Estimate:
        """Return the estimate with step times, and with unknown forces."""
        solution = with_edges(self.fitted.solution)
        identified = refreshed(self.fitted.identified, solution)
        forces = self._forces(solution, [x.instrument for x in identified])
        if forces is not None:
            # The lag's ridge is a property of the input, which unknown forces do not change.
            corrected = replace(forces.solution, modes=solution.modes, alike=solution.alike)
            forces = forces._replace(solution=corrected)
            identified = refreshed(identified, corrected)
        reported = report(solution, self.prepared, self.aircraft, identified=identified, forces=forces)
        values = {x.instrument.name: (x.found.value, x.found.std) for x in identified}
        return replace(
            reported,
            terms=told(self.aircraft.estimation.added, values, self.fitted.solution, self._without),
        )

    def _without(self, term: str) -> Solution | None:
        """Return the solution without one of the user's terms; None without such a solution."""
        other = fit_jointly(self.maneuvers, without_term(self.aircraft, term))
        return None if isinstance(other, NoEstimate) else other.fitted.solution

    def _forces(self, solution: Solution, instruments: Sequence[Instrument]) -> Driven | None:
        """Return the estimate with unknown forces; None if there are none, or if the search diverges."""
        fits = [fit["q"] for fit in channel_fits(solution.assembly, solution.optimum)]
        still = all(fit.lag1 < COLOURED or 1.0 - fit.r2 < UNEXPLAINED for fit in fits)
        if still and not self.prepared.alpha_left_out:
            return None
        estimate = driven_without_alpha if self.prepared.alpha_left_out else driven
        # Gusts can draw output error's instruments so far that the search from there diverges.
        starts = (estimate(at, PITCH, instruments, _priors) for at in (solution, self.plain))
        return next(filter(None, starts), None)


def _priors(problem: OutputErrorProblem, shared: FloatArray) -> Priors:
    """Return the priors of the derivatives for a problem."""
    return about_zero(precision(problem, shared))


def _with_instruments(plain: Solution, aircraft: Aircraft, near: Solution | None) -> InstrumentFit:
    """Return the fit with the instruments, and with the likelier motion of the command.

    A smooth command may be held between its stamps instead of linear, which delays it by half an interval.
    Large steps of the command get their own times.
    """
    linear = fit_instruments(plain, unknown_instruments(plain.problem, aircraft), near)
    records = plain.problem.records
    if any(large_steps(record.elevator).interval for record in records):
        return linear
    problem = replace(plain.problem, records=tuple(replace(record, held=True) for record in records))
    problem = COMMAND_DELAY.write(problem, COMMAND_DELAY.read(plain.problem))
    other = solve(problem, begin=(plain.optimum.shared, plain.optimum.local))
    if isinstance(other, NoEstimate):
        return linear
    held = fit_instruments(other, unknown_instruments(problem, aircraft))
    weighing = Weighing.by(linear.solution.noise.colours, linear.solution.assembly)
    return held if held.misfit(weighing) < linear.misfit(weighing) else linear


def _solved(problem: OutputErrorProblem) -> Solution | NoEstimate:
    """Return the solution with the gravity model that the data clearly prefer.

    Eqs. (1)-(2) take the flight path as constant. Gravity's part in α̇ for a turning path is about 1e-4
    rad/s, and is left out if the data contradict it.
    """
    best = solve(problem)
    if any(record.normal_gravity is not None and record.airspeed is not None for record in problem.records):
        straight = tuple(replace(record, normal_gravity=None) for record in problem.records)
        best = _clearer(best, replace(problem, records=straight))
    return best


def _clearer(best: Solution | NoEstimate, other: OutputErrorProblem) -> Solution | NoEstimate:
    """Return ``best``, or the solution of ``other`` if that explains the data clearly better.

    The other solution must be better under white noise and under coloured noise. If the model is wrong, as
    with an unknown servo, both criteria may contradict each other.
    """
    if isinstance(best, NoEstimate):
        return best
    assembly, optimum = search(other, begin=(best.optimum.shared, best.optimum.local))
    gain = best.optimum.log_likelihood_cost - optimum.log_likelihood_cost
    if optimum.status != CONVERGED or not gain > CLEARLY:
        return best
    weighing = Weighing.by(best.noise.colours, best.assembly)
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
    identified: Sequence[Identified] = (),
    forces: Driven | None = None,
) -> Estimate:
    """Return a solution as a reported estimate.

    Parameters
    ----------
    identified : instrument parameters of the fit.
    forces : estimate with unknown forces, where output error is not valid.
    """
    sound = [x for x in identified if x.instrument.name not in solution.problem.terms]
    filtered = None if forces is None else forces.solution
    source = filtered or solution
    # Optima that explain the record alike predict the response to its input alike.
    predicted = source.widened if source.alike is None else replace(source, modes=None).widened
    best = replace(source, covariance=source.widened)
    airspeed_m_s = solution.problem.reference_airspeed_m_s or prepared.airspeed_m_s
    given, rows = found_of(aircraft), [x.row for x in identified]
    common = np.zeros((N, N)) if given is None else given.covariance_at(airspeed_m_s)
    return Estimate(
        theta=best.theta,
        covariance_cr=best.covariance_cr[:N, :N] + common,
        covariance=best.covariance[:N, :N] + common,
        cost=solution.cost,
        fits=channel_fits(solution.assembly, solution.optimum),
        iterations=solution.optimum.iterations,
        not_identifiable=not_identifiable(best if filtered else solution),
        correlated=correlated(best.covariance_cr[:N, :N]),
        condition=solution.influence.condition,
        airspeed_m_s=airspeed_m_s,
        notes=notes(solution, prepared, aircraft, sound, best=best),
        instruments=(*_given(given), *(x.reported for x in sound if x.reported is not None)),
        fixed=tuple(solution.problem.fixed),
        found=FoundInstruments.of(rows, source.widened, airspeed_m_s) if rows else None,
        common=common,
        given=given,
        gust_rad=None if forces is None else forces.gust_rad,
        filtered=filtered is not None,
        servo_lag_s=best.problem.servo.lag_s,
        prediction=prediction_band(best.assembly, best, predicted),
    )


def _given(given: FoundInstruments | None) -> Iterator[InstrumentEstimate]:
    """Yield the instruments that other manoeuvres have determined, without the coefficients of terms."""
    for name, value, std in zip(given.names, given.values, given.std, strict=True) if given else ():
        if name != "steady_moment_rad" and name in BY_NAME:
            yield InstrumentEstimate(name, float(value), float(std))


def channel_fits(assembly: Laid, optimum: Optimum) -> tuple[dict[str, ChannelFit], ...]:
    """Return measured and fitted values of every manoeuvre and output."""
    outputs = assembly.names.outputs
    return tuple(
        {
            name: ChannelFit(
                name=name,
                t=assembly.t[rows],
                measured=assembly.z[rows],
                fitted=optimum.fitted[rows],
                noise=float(optimum.noise[outputs.index(name)]),
            )
            for name, rows in named.items()
        }
        for named in assembly.rows
    )
