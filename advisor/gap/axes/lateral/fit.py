"""Output-error fit of derivatives, trims and effect parameters together.

The search is that of the estimates (``oem.descent``). Trims, initial states and biases are projected out of
every manoeuvre, so only shared parameters remain. The shared parameters have a Gaussian prior.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from advisor.gap.axes.lateral.setting import Flown, Place, Setting, laid_out, moved_to
from advisor.gap.inference.marginal import Prior
from advisor.model.axes.lateral import LATERAL
from advisor.oem.arrow import unabsorbed
from advisor.oem.axes.lateral.disturbance import Linear
from advisor.oem.axes.lateral.motion import FLOOR, LateralMotion, outputs_of, simulate
from advisor.oem.axes.lateral.problem import ALL, LateralAssembly
from advisor.oem.descent import Response, descended
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Prior as Width
from advisor.oem.gauss_newton import weigh
from advisor.oem.prior import Priors
from advisor.process.arrays import FloatArray

MOST = 40
"""Numerical: largest number of trial steps of a fit; a fit from a tabulated start takes three to six."""
SETTLED = 0.05
"""Numerical: decrease of the cost, -2 log likelihood, in one step, below which a fit has converged: far below
one nat."""
N = len(LATERAL.shared)


class Flying(NamedTuple):
    """Lateral records under one setting of servos and instruments."""

    flown: Flown
    setting: Setting


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

    @property
    def prior(self) -> Width:
        """Prior of the parameter."""
        return Width(self.mean, self.std)

    def within(self, setting: Setting) -> float:
        """Return the parameter's value in a setting; an absent one is zero."""
        return float(setting[self.place][0]) if self.place in setting else 0.0

    def read(self, problem: Flying, /) -> float:
        """Return the parameter's value in a flight."""
        return self.within(problem.setting)

    def moved(self, problem: Flying, change: float, /) -> Flying:
        """Return the records with the parameter changed, within its bounds."""
        value = np.clip(self.read(problem) + change, *self.bounds)
        return Flying(problem.flown, moved_to(problem.setting, [self.place], np.array([value])))


@dataclass(frozen=True, slots=True)
class Known:
    """Gaussian prior of derivatives and effect parameters."""

    mean: FloatArray
    precision: FloatArray
    """Shape (15 + k,): inverse prior variances."""

    def prior(self, values: FloatArray) -> Prior:
        """Return the prior relative to the values (15 + k,) of a fit."""
        return Prior(self.precision, self.mean - values)

    def height(self, fit: "Fit") -> float:
        """Return the log posterior density of a fit, up to a constant."""
        return fit.likelihood - 0.5 * float(self.precision @ (fit.values - self.mean) ** 2)


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
        return np.array([*self.point.theta, *(f.within(self.point.setting) for f in self.free)])

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values, (15 + k,) each."""
        low, high = np.array([(-np.inf, np.inf)] * N + [f.bounds for f in self.free]).T
        return low, high

    @property
    def residual(self) -> FloatArray:
        """Shape (N,): measured minus fitted outputs."""
        return np.asarray(self.assembly.z - self.fitted)

    @property
    def weight(self) -> FloatArray:
        """Shape (N,): inverse standard deviation of each row's noise."""
        return np.asarray(1.0 / self.noise[self.assembly.channel])

    def linear(self, flown: Flown) -> Linear:
        """Return the fit as one whose outputs a disturbance changes."""
        return Linear(flown.problem, self.assembly, self.point.theta, self.sensitivities, self.noise)


def fitted(
    flown: Flown, begin: Point, free: Sequence[Free], prior_known: Known, most: int = MOST
) -> Fit | None:
    """Return the optimum from a start; None if the simulation diverges."""
    std = prior_known.precision**-0.5
    widths = [f._replace(std=width) for f, width in zip(free, std[N:].tolist(), strict=True)]
    prior, place = Priors(prior_known.mean[:N], std[:N]), (begin.theta, begin.local)
    descent = descended(_MOTION, Flying(flown, begin.setting), widths, prior, place, most, SETTLED)
    if isinstance(descent, NoEstimate):
        return None
    return _as_fit(Point(*descent.place, descent.problem.setting), descent.assembly, descent.response, free)


def moved_by(flown: Flown, fit: Fit, change: FloatArray) -> Fit | None:
    """Return a fit after a change (15 + k,) of derivatives and effect parameters.

    Trims, initial states and biases follow the change. None if the simulation diverges.
    """
    columns = np.column_stack([fit.sensitivities[:, :N], fit.slopes])
    left = (fit.residual - columns @ change) * fit.weight
    local, own = fit.point.local.copy(), fit.assembly.own
    for m, rows in enumerate(fit.assembly.blocks):
        mine = fit.sensitivities[rows][:, own] * fit.weight[rows, None]
        local[m, own - N] += np.linalg.lstsq(mine, left[rows], rcond=None)[0]
    places = [f.place for f in fit.free]
    setting = moved_to(fit.point.setting, places, (fit.values + change)[N:])
    point, assembly = Point(fit.point.theta + change[:N], local, setting), laid_out(flown, setting)
    response = _Motion.respond(Flying(flown, setting), assembly, point.theta, local, fit.free)
    return None if response is None else _as_fit(point, assembly, response, fit.free)


class _Motion:
    """Simulated response of roll and yaw under a setting, for the search of the estimates."""

    names = LATERAL.names
    floor, begins = staticmethod(LateralMotion.floor), staticmethod(LateralMotion.begins)

    @staticmethod
    def laid(problem: Flying, /) -> LateralAssembly:
        """Return the measurements as stacked rows."""
        return laid_out(*problem)

    @staticmethod
    def respond(
        problem: Flying, laid: LateralAssembly, theta: FloatArray, local: FloatArray, free: Sequence[Free], /
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""
        simulated = simulate(laid, theta, local)
        if simulated is None:
            return None
        y, g, motion = simulated
        y += _added(problem, free)
        columns = partial(_slopes, problem, theta, local, free, y)
        return Response(y, g[:, :ALL], columns, motion[laid.grid.first[:-1], 1])


_MOTION = _Motion()


def _added(problem: Flying, free: Sequence[Free]) -> FloatArray:
    """Return the outputs' change (N,) by parameters with a known column; zero without such a parameter."""
    return np.asarray(sum(f.read(problem) * f.column for f in free if f.adds and f.column is not None))


def _slopes(
    problem: Flying, theta: FloatArray, local: FloatArray, free: Sequence[Free], y: FloatArray
) -> FloatArray:
    """Return the derivatives (N, k) of the outputs ``y`` (N,) by the effect parameters, by differences."""
    slopes = np.zeros((len(y), len(free)))
    added = _added(problem, free)
    for k, f in enumerate(free):
        if f.column is not None:
            slopes[:, k] = f.column
            continue
        value = f.read(problem)
        step = f.step if value + f.step <= f.bounds[1] else -f.step
        setting = moved_to(problem.setting, [f.place], np.array([value + step]))
        slopes[:, k] = (outputs(problem.flown, Point(theta, local, setting)) + added - y) / step
    return slopes


def _as_fit(point: Point, assembly: LateralAssembly, response: Response, free: Sequence[Free]) -> Fit:
    """Return a fit with its sensitivities, without what local parameters absorb.

    The columns of derivatives that the flight does not show are zero.
    """
    noise, cost = weigh(assembly.z, response.y, assembly.channel, FLOOR)
    slopes, weight = response.columns(), 1.0 / noise[assembly.channel]
    columns = np.column_stack([response.g[:, :N], slopes])
    for rows in assembly.blocks:
        columns[rows] = unabsorbed(columns[rows], response.g[rows][:, assembly.own], weight[rows])
    columns[:, [k for k in range(N) if k not in assembly.free]] = 0.0
    return Fit(point, assembly, tuple(free), response.y, noise, -0.5 * cost, columns, slopes, response.g)


def outputs(flown: Flown, point: Point) -> FloatArray:
    """Return the simulated outputs (N,) at a point of the parameters."""
    return outputs_of(laid_out(flown, point.setting), point.theta, point.local)
