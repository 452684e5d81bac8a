"""Instrument parameters estimated together with the derivatives: servo lag, arm or delay of the vane.

A log holds the command, not the surface. An ignored servo lag of 0.14 s halves M_α and M_δe of a small
aircraft, while the fit still explains 95 % of the motion. A vane ahead of the centre of gravity reads α -
(x/V)·q, and an autopilot's own angle of attack is late. Both change Z_α, Z_q, Z_δe and M_q while α and q fit
as well as before. With a_z and air speed the kinematics distinguish instrument and aircraft.

Each unknown instrument is one more shared parameter. Gauss-Newton steps move all of them with everything else
refitted. A value is kept only where the data distinguish it from zero beyond doubt.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from advisor.aircraft.aircraft import PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.model.response import N_PARAMETERS, respond
from advisor.oem.covariance import influence
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.problem import Assembly, OutputErrorProblem, assemble
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.surface import Servo
from advisor.oem.weighing import Weighing

InstrumentName = Literal["servo_lag_s", "vane_arm_m", "alpha_delay_s", "accelerometer_arm_m"]

N = len(PARAMETERS)
ROUNDS = 12
SETTLED = 1e-2
"""Change of Σ n·log σ², per round, below which the search for instrument parameters is done."""
CLOSE_ENOUGH = 1e-7
"""Promised change of log J per sample at which an intermediate search ends."""
CLEARLY = 9.0
"""Least gain in twice the log likelihood for a parameter: three standard deviations."""
KNOWN_TO = 0.1
"""Largest standard deviation over the value for which the value represents the aircraft. An error of a tenth
of a usual servo lag moves M_δe by some 5 %, the default tolerance of a campaign."""
SMALLEST_DELAY_S = 0.004
"""Smallest delay of the angle of attack that matters, s: a fifth of a sample at 50 Hz."""
SMALLEST_ARM_M = 0.02
"""Smallest distance of an accelerometer from the centre of gravity that matters, m."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """One instrument parameter, and its place in a problem."""

    name: InstrumentName
    read: Callable[[OutputErrorProblem], float]
    write: Callable[[OutputErrorProblem, float], OutputErrorProblem]
    difference: float
    """Step of central differences, in the parameter's unit."""
    lowest: float
    highest: float
    starts: tuple[float, ...]
    """Values at which the search starts, in addition to the present one."""
    smallest: Callable[[OutputErrorProblem], float]
    """Smallest value that the sampling of the record can show, in the parameter's unit."""


def _with_lag(problem: OutputErrorProblem, value: float) -> OutputErrorProblem:
    return replace(problem, servo=Servo(value, problem.servo.delay_s))


def _with_arm(problem: OutputErrorProblem, value: float) -> OutputErrorProblem:
    return replace(problem, vane_arm_m=value)


def _with_delay(problem: OutputErrorProblem, value: float) -> OutputErrorProblem:
    return replace(problem, alpha_delay_s=value)


def _with_imu(problem: OutputErrorProblem, value: float) -> OutputErrorProblem:
    return replace(problem, accelerometer_arm_m=value)


def _half_interval(problem: OutputErrorProblem) -> float:
    """Return half the interval of the command. A shorter lag looks like an unknown time between two
    stamps."""
    return 0.5 * float(np.median(np.concatenate([np.diff(r.elevator.t) for r in problem.records])))


def _smallest_arm(problem: OutputErrorProblem) -> float:
    speeds = [float(np.mean(r.airspeed.y)) for r in problem.records if r.airspeed is not None]
    return SMALLEST_DELAY_S * float(np.mean(speeds)) if speeds else 0.0


SERVO_LAG = Instrument(
    "servo_lag_s",
    lambda problem: problem.servo.lag_s,
    _with_lag,
    1e-4,
    0.0,
    0.4,
    (0.03, 0.06, 0.1, 0.15, 0.22),
    _half_interval,
)
VANE_ARM = Instrument(
    "vane_arm_m", lambda problem: problem.vane_arm_m, _with_arm, 1e-3, -100.0, 100.0, (), _smallest_arm
)
ALPHA_DELAY = Instrument(
    "alpha_delay_s",
    lambda problem: problem.alpha_delay_s,
    _with_delay,
    1e-4,
    -0.3,
    0.5,
    (),
    lambda _: SMALLEST_DELAY_S,
)
ACCELEROMETER_ARM = Instrument(
    "accelerometer_arm_m",
    lambda problem: problem.accelerometer_arm_m,
    _with_imu,
    1e-3,
    -100.0,
    100.0,
    (),
    lambda _: SMALLEST_ARM_M,
)
OF_ALPHA = (VANE_ARM, ALPHA_DELAY)
"""Two readings of an angle of attack that contradict the kinematics in nearly equal ways; at most one is
kept."""


@dataclass(frozen=True, slots=True)
class Identified:
    """An instrument parameter that the data determine."""

    instrument: Instrument
    value: float
    std: float
    """Corrected standard deviation, in the parameter's unit."""


@dataclass(frozen=True, slots=True)
class InstrumentFit:
    """A solution with the instrument parameters that the data determine."""

    solution: Solution
    """Solution whose ``extra`` columns are the derivatives by ``identified``, in that order."""
    identified: tuple[Identified, ...] = ()


class _Fit(NamedTuple):
    """The optimum at one setting of the instruments."""

    problem: OutputErrorProblem
    assembly: Assembly
    optimum: Optimum

    @property
    def cost(self) -> float:
        return self.optimum.log_likelihood_cost


def fit_instruments(plain: Solution, unknown: Sequence[Instrument]) -> InstrumentFit:
    """Estimate the unknown instrument parameters that the data determine; ``plain`` is the solution without
    any.

    A parameter is kept where the record is clearly likelier with it, for noise of the residuals' colour. The
    likelihood ratio holds where an error from the curvature does not. On a well damped aircraft a servo's lag
    is correlated with M_q and M_δe over a long range.
    """
    begin = _Fit(plain.problem, plain.assembly, plain.optimum)
    common = tuple(x for x in unknown if x not in OF_ALPHA)
    near = _looked_about(begin, common)
    choices = [(*common, x) for x in unknown if x in OF_ALPHA] or [common]
    fits = [(names, _descend(near, names)) for names in choices if names]
    names, best = min(fits, key=lambda found: found[1].cost, default=((), begin))
    while names:
        solution = _solution(best, names)
        if solution is None:
            return InstrumentFit(plain)
        rivals = [(x, _without(x, best, names, plain)) for x in names]
        weighing = Weighing.by(solution.noise, solution.assembly)
        gains = [_gain(weighing, best, rival) for _, rival in rivals]
        small = [abs(x.read(best.problem)) < x.smallest(best.problem) for x in names]
        gains = [0.0 if is_small else gain for gain, is_small in zip(gains, small, strict=True)]
        weakest = int(np.argmin(gains))
        if gains[weakest] >= CLEARLY:
            return InstrumentFit(solution, identified_at(solution, names))
        names, best = tuple(x for x in names if x is not names[weakest]), rivals[weakest][1]
    return InstrumentFit(plain)


def _without(x: Instrument, best: _Fit, names: Sequence[Instrument], plain: Solution) -> _Fit:
    """Return the optimum with one instrument set back to the aircraft file's value."""
    begin = _Fit(plain.problem, plain.assembly, plain.optimum)
    others = [other for other in names if other is not x]
    reset = x.write(best.problem, x.read(plain.problem))
    return _descend(_at(reset, best) or begin, others)


def _gain(weighing: Weighing, fit: _Fit, rival: _Fit) -> float:
    """Return twice the log likelihood ratio of a fit over a rival, under one noise model."""

    def misfit(of: _Fit) -> float:
        return weighing.misfit(of.assembly.z - of.optimum.fitted, of.optimum.sensitivities)

    return misfit(rival) - misfit(fit)


def by_instruments(
    problem: OutputErrorProblem, shared: FloatArray, local: FloatArray, names: Sequence[Instrument]
) -> FloatArray:
    """Return (N, k) derivatives of the outputs by instrument parameters; ``shared`` (7,), ``local`` (m,
    7)."""
    columns = []
    for x in names:
        sides = []
        value = max(x.read(problem), x.lowest + 2.0 * x.difference)
        for sign in (-1.0, 1.0):
            assembly = assemble(x.write(problem, value + sign * x.difference))
            y = np.empty(len(assembly.z))
            respond(assembly.grid, shared, local, y, np.empty((0, N_PARAMETERS)))
            sides.append(y)
        columns.append((sides[1] - sides[0]) / (2.0 * x.difference))
    return np.column_stack(columns) if columns else np.empty((len(assemble(problem).z), 0))


def _looked_about(begin: _Fit, names: Sequence[Instrument]) -> _Fit:
    """Return the best of the starts of each instrument, one instrument after the other."""
    best = begin
    for x in names:
        near = best
        for start in x.starts:
            near = _at(x.write(best.problem, start), near) or near
            if near.cost > best.cost:
                break
            best = near
    return best


def _descend(begin: _Fit, names: Sequence[Instrument]) -> _Fit:
    """Minimise the cost over the instruments by Gauss-Newton, with everything else refitted at each step."""
    best = begin
    for _ in range(ROUNDS if names else 0):
        step = _step(best, names)
        found = None
        for _ in range(5):
            found = _at(_moved(best.problem, names, step), best)
            if found is not None and found.cost < best.cost:
                break
            step, found = step / 4.0, None
        if found is None:
            break
        gain, best = best.cost - found.cost, found
        if gain < SETTLED:
            break
    return best


def _moved(problem: OutputErrorProblem, names: Sequence[Instrument], step: FloatArray) -> OutputErrorProblem:
    for x, change in zip(names, step, strict=True):
        problem = x.write(problem, float(np.clip(x.read(problem) + change, x.lowest, x.highest)))
    return problem


def _step(fit: _Fit, names: Sequence[Instrument]) -> FloatArray:
    """Return the Gauss-Newton step of the instruments with everything else free, shape (k,)."""
    optimum = fit.optimum
    columns = by_instruments(fit.problem, optimum.shared, optimum.local, names)
    effect = influence(fit.assembly, optimum.sensitivities, optimum.noise, columns)
    if effect is None:
        return np.zeros(len(names))
    weight = 1.0 / optimum.noise[fit.assembly.channel] ** 2
    gradient = columns.T @ (weight * (fit.assembly.z - optimum.fitted))
    return np.asarray(effect.extra_covariance @ gradient)


def _at(problem: OutputErrorProblem, near: _Fit) -> _Fit | None:
    begin = (near.optimum.shared, near.optimum.local)
    assembly, optimum = search(problem, begin=begin, flat=CLOSE_ENOUGH)
    return _Fit(problem, assembly, optimum) if optimum.status == CONVERGED else None


def identified_at(solution: Solution, names: Sequence[Instrument]) -> tuple[Identified, ...]:
    """Return values and errors of instruments in a solution whose first extra columns are theirs."""
    std = np.sqrt(np.diag(solution.covariance)[N : N + len(names)])
    return tuple(Identified(x, x.read(solution.problem), float(s)) for x, s in zip(names, std, strict=True))


def _solution(fit: _Fit, names: Sequence[Instrument]) -> Solution | None:
    columns = by_instruments(fit.problem, fit.optimum.shared, fit.optimum.local, names)
    found = evaluate(*fit, columns)
    return found if isinstance(found, Solution) else None
