"""Output-error fit of derivatives, trims and effect parameters together.

The fit takes Gauss-Newton steps. Trims, initial states and biases are projected out of every manoeuvre, so
only shared parameters remain. The shared parameters have a Gaussian prior.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.axes.lateral.setting import Flown, Place, Setting, laid_out, moved_to
from advisor.gap.inference.marginal import Prior
from advisor.model.axes.lateral import LATERAL
from advisor.oem.arrow import solved_within, unabsorbed
from advisor.oem.axes.lateral.motion import FLOOR, outputs_of, simulate
from advisor.oem.axes.lateral.problem import LateralAssembly
from advisor.oem.gauss_newton import weigh

ROUNDS = 12
"""Largest number of Gauss-Newton steps of a fit; a fit from a tabulated start takes three to six."""
SETTLED = 0.05
"""Decrease of the cost, -2 log likelihood, in one step, below which a fit has converged: far below one
nat."""
N = len(LATERAL.shared)


class Free(NamedTuple):
    """One effect parameter that a fit estimates."""

    place: Place
    std: float
    """Prior standard deviation of the parameter about zero, or about ``mean``."""
    step: float
    """Finite-difference step of the parameter."""
    bounds: tuple[float, float] = (-np.inf, np.inf)
    mean: float = 0.0
    column: FloatArray | None = None
    """Shape (N,): known derivative of the outputs by the parameter; None: computed by differences in every
    step."""
    adds: bool = False
    """Whether the parameter adds its column to the simulated outputs, so that no simulation uses it."""


@dataclass(frozen=True, slots=True)
class Known:
    """Gaussian prior of derivatives and effect parameters."""

    mean: FloatArray
    precision: FloatArray
    """Shape (15 + k,): inverse prior variances."""

    def prior(self, values: FloatArray) -> Prior:
        """Return the prior relative to the values (15 + k,) of a fit."""
        return Prior(self.precision, self.mean - values)


class Point(NamedTuple):
    """Parameters of a fit: derivatives, effect parameters and local parameters."""

    theta: FloatArray
    """(15,)"""
    local: FloatArray
    """Shape (m, l): trims, initial states and biases of each manoeuvre."""
    setting: Setting


@dataclass(frozen=True, slots=True)
class Fit:
    """Optimum of one model's fit."""

    point: Point
    assembly: LateralAssembly
    free: tuple[Free, ...]
    fitted: FloatArray
    """Shape (N,): simulated outputs at the optimum."""
    noise: FloatArray
    """(outputs,)"""
    likelihood: float
    """Log likelihood for white noise, up to a constant."""
    columns: FloatArray
    """Shape (N, 15 + k): sensitivities to shared parameters, without what trims, initial states and biases
    absorb."""
    slopes: FloatArray
    """Shape (N, k): derivatives of the outputs by the effect parameters."""
    sensitivities: FloatArray
    """Shape (N, 15 + l): derivatives of the outputs by the aerodynamic derivatives and the local
    parameters."""

    @property
    def values(self) -> FloatArray:
        """Shape (15 + k,): values of the derivatives and of the effect parameters."""
        return np.concatenate([self.point.theta, _numbers(self.point, self.free)])

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values, (15 + k,) each."""
        low, high = np.array([(-np.inf, np.inf)] * N + [one.bounds for one in self.free]).T
        return low, high

    @property
    def residual(self) -> FloatArray:
        """Shape (N,): measured minus fitted outputs."""
        return np.asarray(self.assembly.z - self.fitted)

    @property
    def weight(self) -> FloatArray:
        """Shape (N,): inverse standard deviation of each row's noise."""
        return np.asarray(1.0 / self.noise[self.assembly.channel])


def fitted(
    flown: Flown, begin: Point, free: Sequence[Free], known: Known, rounds: int = ROUNDS
) -> Fit | None:
    """Return the optimum from a start; None where the simulation diverges."""
    at = _at(flown, begin, free, known)
    if at is None:
        return None
    for _ in range(rounds):
        slopes = _slopes(flown, at)
        step = _step(at, slopes, known)
        trials = _trials(flown, at, known, step) if step.promise > SETTLED else iter(())
        moved = next(filter(None, trials), None)
        if moved is None:
            break
        gain, at = at.cost - moved.cost, moved
        if gain < SETTLED:
            break
    # A step that gains so little changes no slope.
    return _as_fit(at, slopes)


def moved_by(flown: Flown, fit: Fit, change: FloatArray, known: Known) -> Fit | None:
    """Return a fit after a change (15 + k,) of derivatives and effect parameters.

    Trims, initial states and biases follow the change. None where the simulation diverges.
    """
    at = _at(flown, fit.point, fit.free, known)
    assert at is not None
    trial = _at(flown, _moved(at, _step(at, fit.slopes, known), change), fit.free, known)
    return None if trial is None else _as_fit(trial, _slopes(flown, trial))


def _as_fit(at: "_At", slopes: FloatArray) -> Fit:
    columns = np.column_stack([at.g[:, :N], slopes])
    projected, _ = _projected(at, columns, 1.0 / at.noise[at.assembly.channel])
    return Fit(at.point, at.assembly, tuple(at.free), at.y, at.noise, at.likelihood, projected, slopes, at.g)


class _At(NamedTuple):
    point: Point
    free: Sequence[Free]
    assembly: LateralAssembly
    y: FloatArray
    g: FloatArray
    noise: FloatArray
    likelihood: float
    cost: float


def _at(flown: Flown, point: Point, free: Sequence[Free], known: Known) -> _At | None:
    assembly = laid_out(flown, point.setting)
    found = simulate(assembly, point.theta, point.local)
    if found is None:
        return None
    y, g, _motion = found
    y += _added(point, free)
    noise, minus_twice = weigh(assembly.z, y, assembly.channel, FLOOR)
    off = np.concatenate([point.theta, _numbers(point, free)]) - known.mean
    cost = float(minus_twice + off @ (known.precision * off))
    return _At(point, free, assembly, y, g, noise, -0.5 * minus_twice, cost)


class _Step(NamedTuple):
    """A Gauss-Newton step with its linear model."""

    values: FloatArray
    """Shape (15 + k,): derivatives and effect parameters before the step."""
    change: FloatArray
    """Shape (15 + k,): change of the derivatives and effect parameters by the step."""
    columns: FloatArray
    """Shape (N, 15 + k): weighted derivatives of the outputs."""
    residual: FloatArray
    """Shape (N,): weighted residual."""
    own: list[tuple[slice, FloatArray]]
    """Rows of each manoeuvre, and the weighted derivatives by the manoeuvre's local parameters."""
    promise: float
    """Decrease of the cost that the linear model promises."""


def _step(at: _At, slopes: FloatArray, known: Known) -> _Step:
    """Return the Gauss-Newton step within the bounds of all effect parameters."""
    columns = np.column_stack([at.g[:, :N], slopes])
    weight = 1.0 / at.noise[at.assembly.channel]
    residual = weight * (at.assembly.z - at.y)
    projected, own = _projected(at, columns, weight)
    values = np.concatenate([at.point.theta, _numbers(at.point, at.free)])
    weighed = projected * weight[:, None]
    information = weighed.T @ weighed + np.diag(known.precision)
    pull = weighed.T @ residual + known.precision * (known.mean - values)
    low, high = np.array([(-np.inf, np.inf)] * N + [f.bounds for f in at.free]).T
    change = solved_within(information, pull, low - values, high - values)
    promise = float(2.0 * pull @ change - change @ information @ change)
    for rows, mine in own:
        promise += float(residual[rows] @ mine @ np.linalg.lstsq(mine, residual[rows], rcond=None)[0])
    return _Step(values, change, columns * weight[:, None], residual, own, promise)


def _trials(flown: Flown, at: _At, known: Known, step: _Step) -> Iterator[_At | None]:
    """Yield points along the step, each a quarter as far as the one before, that lower the cost; else
    None."""
    for share in (1.0, 0.25, 0.06):
        trial = _at(flown, _moved(at, step, share * step.change), at.free, known)
        yield trial if trial is not None and trial.cost < at.cost else None


def _moved(at: _At, step: _Step, change: FloatArray) -> Point:
    """Return the point after a change (15 + k,), with the local parameters that the linear model then has."""
    left = step.residual - step.columns @ change
    local = at.point.local.copy()
    for m, (rows, mine) in enumerate(step.own):
        local[m, at.assembly.own - N] += np.linalg.lstsq(mine, left[rows], rcond=None)[0]
    numbers = (step.values + change)[N:]
    setting = moved_to(at.point.setting, [f.place for f in at.free], numbers)
    return Point(at.point.theta + change[:N], local, setting)


def _projected(
    at: _At, columns: FloatArray, weight: FloatArray
) -> tuple[FloatArray, list[tuple[slice, FloatArray]]]:
    """Return the columns without what local parameters absorb, and each manoeuvre's weighted local columns.

    The columns of derivatives that the flight does not show are zero.
    """
    result, bases = columns.copy(), []
    for rows in at.assembly.blocks:
        mine = at.g[rows][:, at.assembly.own]
        bases.append((rows, mine * weight[rows, None]))
        result[rows] = unabsorbed(columns[rows], mine, weight[rows])
    result[:, [k for k in range(N) if k not in at.assembly.free]] = 0.0
    return result, bases


def _slopes(flown: Flown, at: _At) -> FloatArray:
    """Return the finite-difference derivatives (N, k) of the outputs by the effect parameters."""
    found = np.zeros((len(at.y), len(at.free)))
    for k, (one, value) in enumerate(zip(at.free, _numbers(at.point, at.free), strict=True)):
        if one.column is not None:
            found[:, k] = one.column
            continue
        step = one.step if value + one.step <= one.bounds[1] else -one.step
        y = outputs(
            flown,
            at.point._replace(setting=moved_to(at.point.setting, [one.place], np.array([value + step]))),
        )
        found[:, k] = (y + _added(at.point, at.free) - at.y) / step
    return found


def _added(point: Point, free: Sequence[Free]) -> FloatArray:
    """Return the outputs' change (N,) by parameters whose column is known; zero without one."""
    return np.asarray(sum(x * f.column for x, f in zip(_numbers(point, free), free, strict=True) if f.adds))


def outputs(flown: Flown, point: Point) -> FloatArray:
    """Return the simulated outputs (N,) at a point of the parameters."""
    return outputs_of(laid_out(flown, point.setting), point.theta, point.local)


def _numbers(point: Point, free: Sequence[Free]) -> FloatArray:
    return np.array([point.setting[f.place][0] if f.place in point.setting else 0.0 for f in free])
