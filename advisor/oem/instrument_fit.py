"""Estimation of instrument parameters together with the derivatives.

One search estimates instruments and derivatives together (``descent``). Three kinds of parameters differ in
the knowledge before the flight:

- *The delays of the command and of the angle of attack* are nuisance parameters of every log. Each delay has
  a prior, and every interval includes the errors of both delays. A delay of α and a vane's arm look nearly
  alike, but differ in Z_α by Z_α² times the delay. The fit therefore has a delay and an arm.
- *An open parameter*, such as a servo's lag, has the prior of an unmeasured instrument. On a well damped
  aircraft a lag is correlated with M_q and M_δe over a long range, and every interval includes that error.
- *A stated parameter* is also estimated without the statement. If data and statement agree, the statement is
  a prior with a width. If the data contradict a stated lag of zero slightly, its prior is as wide as their
  distance from zero. If data and statement exclude each other, the data decide alone, and the contradiction
  is reported.

A lost output sample costs only its own information. A lost input sample costs far more, because every later
output is simulated wrongly. With a straight line across the gap, a step lies up to an interval from its true
place. The outputs determine the true place of the step. Missing samples across a change of the command become
parameters, bounded by their neighbours. Gauss-Newton estimates the missing samples together with the
aircraft.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import N_PARAMETERS, SHARED
from advisor.model.response import respond
from advisor.model.short_period import NAMES
from advisor.oem.covariance import Weighing
from advisor.oem.descent import Fit, Response, descended
from advisor.oem.driven_motion.setting import Linear
from advisor.oem.estimate import InstrumentEstimate, NoEstimate
from advisor.oem.evaluation import share_of
from advisor.oem.extra import Prior, penalty
from advisor.oem.gauss_newton import CONVERGED, MOST_ITERATIONS
from advisor.oem.instruments import SERVO_LAG, Instrument, extra_of
from advisor.oem.prior import about_zero, precision, usual_moments
from advisor.oem.problem import ASSUMED_M_S, Assembly, OutputErrorProblem, assemble
from advisor.oem.profile import ALIKE_NATS, Posterior, profiled
from advisor.oem.short_period_motion import short_period_motion
from advisor.oem.solution import Solution, evaluate, spread_of
from advisor.process.arrays import FloatArray

N = len(PARAMETERS)
LOOK = 4
"""Numerical: iterations of a search at a given lag. The starting values of a lag differ by hundreds of times
as much as what is left."""
MODEL_ERROR = 1e-3
"""Numerical: error of the model's outputs, relative to their spread. A surface with a lag is taken as linear
between the grid's stamps (``rows``)."""
SAME_SENSOR_S = 0.002
"""Standard deviation of the delay between specific force and pitch rate, s, which one sensor measures. The
stamps of two messages are rounded to 1 ms. The messages leave the autopilot's loop up to some milliseconds
apart. 2 ms move Z_α of a small aircraft by 3 %. This delay, Z_q and the delay of α look alike,
so the delay is not estimated."""
CONTRADICTS = 3.0
"""Distance of a stated value from the data's value, in combined standard deviations, that is a
contradiction."""


Near = Fit | Solution
"""Place from which a search starts, with the problem to search."""


class Identified(NamedTuple):
    """An instrument parameter of a fit."""

    instrument: Instrument
    found: InstrumentEstimate

    @property
    def row(self) -> tuple[str, float, Prior | None]:
        """Name, value and prior of the parameter."""
        return self.instrument.name, self.found.value, self.instrument.prior

    @property
    def reported(self) -> InstrumentEstimate | None:
        """Instrument parameter as reported; None for a moment of the aircraft."""
        return None if self.instrument.name == "steady_moment_rad" else self.found


@dataclass(frozen=True, slots=True)
class InstrumentFit:
    """A solution with its instrument parameters."""

    solution: Solution
    """Solution whose ``extra`` columns are the derivatives by ``identified``, in that order."""
    identified: tuple[Identified, ...] = ()
    one_hill: bool = False
    """Whether the posterior along a servo's lag has one hill."""

    def misfit(self, weighing: Weighing) -> float:
        """Return -2 log posterior density of the solution, up to a constant, under one noise model."""
        solution = self.solution
        prior = penalty(solution.problem, [x.instrument for x in self.identified])
        return weighing.misfit(solution.residual, solution.sensitivities) + prior


class _Pitch:
    """Simulated response of the short period, with the derivatives by all parameters."""

    names = NAMES
    laid = staticmethod(assemble)

    @staticmethod
    def floor(laid: Assembly, /) -> FloatArray:
        """Return a thousandth of each output's spread as least noise, SI."""
        return MODEL_ERROR * spread_of(laid)

    @staticmethod
    def begins(laid: Assembly, /) -> FloatArray:
        """Return zero for each record: initial states belong to the records' first samples."""
        return np.zeros(laid.maneuvers)

    @staticmethod
    def linear(problem: OutputErrorProblem, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` in α, q and θ at its mean air speed."""
        airspeed = problem.records[m].airspeed
        speed = ASSUMED_M_S if airspeed is None else float(np.mean(airspeed.y))
        ratio = speed / (problem.reference_airspeed_m_s or speed)
        of = dict(zip(SHARED, shared.tolist(), strict=True))
        system = ratio * of["Z_alpha"], of["Z_q"], ratio**2 * of["M_alpha"], ratio * of["M_q"]
        return short_period_motion(
            np.array(system),
            speed,
            (problem.vane_arm_m, problem.accelerometer_arm_m),
            seen_by_alpha=not problem.alpha_is_computed,
            scale=1.0 + of["airspeed_scale"],
        )

    @staticmethod
    def unsure(laid: Assembly, y: FloatArray, /) -> FloatArray:
        """Return the change of the outputs by a standard deviation of the specific force's delay, (N, 1)."""
        column = np.zeros((len(y), 1))
        for rows in (named["a_z"] for named in laid.rows if "a_z" in named):
            column[rows, 0] = -SAME_SENSOR_S * np.gradient(y[rows], laid.t[rows])
        return column

    @staticmethod
    def respond(
        problem: OutputErrorProblem,
        laid: Assembly,
        shared: FloatArray,
        local: FloatArray,
        names: Sequence[Instrument],
        /,
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""
        y, g = np.empty(len(laid.z)), np.empty((len(laid.z), N_PARAMETERS))
        if not respond(laid.grid, shared, local, y, g):
            return None

        def columns() -> FloatArray:
            return extra_of(problem, laid, shared, local, names).columns

        return Response(y, g, columns, np.empty((laid.maneuvers, 0)))


PITCH = _Pitch()


def fit_instruments(
    plain: Solution, unknown: Sequence[Instrument], near: Solution | None = None
) -> InstrumentFit:
    """Return the solution with estimated instrument parameters; ``plain`` is the solution without them.

    Parameters
    ----------
    unknown
        Instruments with a prior, open instruments, and stated instruments.
    near
        Start on the one hill of earlier records. None: every hill is searched.
    """
    if not unknown:
        return InstrumentFit(plain)
    share = colour_share(plain)
    names = tuple(weighed(x, share) for x in unknown)
    best, *others = _hills(plain, names, share) if near is None else [near]
    fitted = _fitted(best, names, share, final=False)
    if fitted is not None:
        share = colour_share(fitted)
        names = tuple(weighed(x, share) for x in unknown)
        fitted = _fitted(fitted, names, share)
    if fitted is None:
        return InstrumentFit(plain) if near is None else fit_instruments(plain, unknown)
    return _with_statements(names, _whole_posterior(fitted, names, others), plain, others)


def _hills(plain: Solution, names: Sequence[Instrument], share: float) -> list[Near]:
    """Return a start on each hill of the posterior along a servo's lag, the highest hill first.

    All other parameters are searched at each lag, because a delay of the command hides the hill of a short
    lag. A measured surface has a stated lag of zero, and one hill.
    """
    lag = next((x for x in names if x.starts and x.stated != 0.0), None)
    if lag is None:
        return [plain]
    others = [x for x in names if x is not lag]
    costs, fits = [np.inf], list[Near]([plain])
    for value in lag.starts:
        there = replace(fits[-1], problem=lag.write(fits[-1].problem, value))
        fit = _descended(there, others, share, LOOK)
        if not isinstance(fit, NoEstimate):
            costs.append(fit.cost + penalty(fit.problem, [lag]))
            fits.append(fit)
    heights = np.array([*costs, np.inf])
    higher = 1 + np.flatnonzero((heights[1:-1] <= heights[:-2]) & (heights[1:-1] < heights[2:]))
    return [fits[k] for k in sorted(higher, key=lambda k: float(heights[k]))] or [plain]


def _whole_posterior(best: Solution, names: Sequence[Instrument], others: Sequence[Near]) -> Solution:
    """Return the solution with the posterior over every hill along a servo's lag, if none is stated.

    ``others`` are starts on the other hills.
    """
    lag = next((x for x in names if x.name == SERVO_LAG.name and x.stated is None), None)
    if lag is None:
        return best
    posterior = Posterior(names, colour_share(best), usual_moments)

    def refit(free: Sequence[Instrument], there: OutputErrorProblem, near: Near) -> Fit | None:
        return _searched(replace(near, problem=there), free, posterior.share)

    return profiled(_of_two_hills(best, others, posterior), lag, posterior, refit)


def _of_two_hills(best: Solution, others: Sequence[Near], posterior: Posterior) -> Solution:
    """Return the likelier of two solutions, with the other one's second moment times its probability."""
    fits = [_searched(at, posterior.parameters, posterior.share) for at in others]
    rival = min((fit for fit in fits if fit is not None), key=lambda fit: fit.cost, default=None)
    if rival is None:
        return best
    lower, moment = posterior.apart(best, rival)
    likelier = best if lower >= 0.0 else _evaluated(rival)
    if likelier is None:
        return best
    own, other = (posterior.row(at, SERVO_LAG) for at in ((best, rival) if lower >= 0.0 else (rival, best)))
    return replace(likelier, modes=moment, alike=np.array([own, other]) if abs(lower) <= ALIKE_NATS else None)


def _fitted(near: Near, names: Sequence[Instrument], share: float, final: bool = True) -> Solution | None:
    """Return the solution with instruments near another one; None if the search fails."""
    fit = _searched(near, names, share)
    return None if fit is None else _evaluated(fit, final)


def _searched(near: Near, names: Sequence[Instrument], share: float) -> Fit | None:
    """Return the fit with instruments near another one; None if the search fails."""
    fit = _descended(near, names, share, MOST_ITERATIONS)
    return None if isinstance(fit, NoEstimate) or fit.optimum.status != CONVERGED else fit


def _descended(near: Near, names: Sequence[Instrument], share: float, most: int) -> Fit | NoEstimate:
    """Return the fit with instruments near another one, after at most ``most`` iterations.

    ``share`` is the factor on the derivative priors' standard deviations in a white-noise fit.
    """
    problem, place = near.problem, (near.optimum.shared, near.optimum.local)
    prior = replace(about_zero(precision(problem, place[0])), share=share)
    return descended(PITCH, problem, names, prior, place, most)


def _evaluated(fit: Fit, final: bool = True) -> Solution | None:
    """Return the solution at a fit; None if the data do not determine it."""
    solution = evaluate(fit.problem, fit.assembly, fit.optimum, fit.extra, final=final)
    return solution if isinstance(solution, Solution) else None


def colour_share(solution: Solution) -> float:
    """Return the ratio of the parameters' errors under white noise to those under coloured noise."""
    return share_of(solution.covariance_cr[:N, :N], solution.covariance[:N, :N])


def weighed(x: Instrument, share: float) -> Instrument:
    """Return the instrument with ``share`` as the factor on its prior's standard deviation."""
    return x if x.prior is None else replace(x, prior=replace(x.prior, share=share))


def _with_statements(
    names: tuple[Instrument, ...], solution: Solution, plain: Solution, others: Sequence[Near]
) -> InstrumentFit:
    """Return the fit in which a stated value is a prior unless the data exclude it.

    ``others`` are starts on the other hills of the posterior.
    """
    alone = identified_at(solution, names)
    white = np.sqrt(np.diag(solution.covariance_cr)[N:])
    if all(x.instrument.stated is None or x.found.contradicts for x in alone):
        return InstrumentFit(solution, alone, not others)
    kept, problem = [], solution.problem
    for identified, white_std in zip(alone, white, strict=True):
        x, value = identified
        share = min(1.0, float(white_std) / value.std)
        if x.stated is None or value.contradicts:
            kept.append(identified._replace(instrument=weighed(x, share)))
            continue
        # A statement is trusted no better than the data confirm it. A confirmed zero holds exactly.
        apart = abs(value.unstated_value - x.stated)
        if x.known_to > 0.0 and (x.stated != 0.0 or apart > value.unstated_std):
            width = max(x.known_to * abs(x.stated), apart)
            kept.append(identified._replace(instrument=replace(x, prior=Prior(x.stated, width, share))))
        else:
            problem = x.write(problem, x.stated)
            others = [replace(at, problem=x.write(at.problem, x.stated)) for at in others]
    left = tuple(identified.instrument for identified in kept)
    final = _fitted(replace(solution, problem=problem), left, colour_share(solution))
    if final is None:
        return InstrumentFit(plain)
    final = _whole_posterior(final, left, others)
    return InstrumentFit(final, refreshed(kept, final), not others)


def refreshed(identified: Sequence[Identified], solution: Solution) -> tuple[Identified, ...]:
    """Return the instruments with the values and errors of another solution. Findings about stated values are
    unchanged."""
    now = identified_at(solution, [x.instrument for x in identified])
    return tuple(
        there
        if x.instrument.stated is None
        else x._replace(found=replace(x.found, value=there.found.value, std=there.found.std))
        for x, there in zip(identified, now, strict=True)
    )


def identified_at(solution: Solution, names: Sequence[Instrument]) -> tuple[Identified, ...]:
    """Return values and errors of the instruments that are a solution's first extra parameters."""
    std = np.sqrt(np.diag(solution.widened)[N : N + len(names)])
    return tuple(_identified(x, solution.problem, float(s)) for x, s in zip(names, std, strict=True))


def _identified(x: Instrument, problem: OutputErrorProblem, std: float) -> Identified:
    value, off = x.read(problem), False
    if x.stated is not None:
        apart = abs(value - x.stated)
        excluded = apart > CONTRADICTS * float(np.hypot(std, x.known_to * x.stated))
        off = excluded and not x.at_end(problem, std)
    elif x.prior is not None:
        # Sound instruments all lie within the prior; a servo's lag with a prior was told by other manoeuvres.
        odd = abs(value - x.prior.mean) > CONTRADICTS * float(np.hypot(std, x.prior.std))
        off = odd and x.name == "command_delay_s"
    return Identified(x, InstrumentEstimate(x.name, value, std, x.stated, value, std, off))
