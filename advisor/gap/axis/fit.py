"""Output-error fit of derivatives, trims and effect parameters together.

The search is that of the estimates (``oem.descent``). Trims, initial states and biases are projected out of
every manoeuvre, so only shared parameters remain. The shared parameters have a Gaussian prior.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.gap.axis.setting import Flown, Setting, column_of_change, filtered, laid_out, moved_to
from advisor.gap.inference.marginal import Prior
from advisor.model.axis import Names, Place
from advisor.oem.arrow import unabsorbed
from advisor.oem.axis.disturbance import Linear
from advisor.oem.axis.motion import column_of, outputs_of, simulate
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import AxisAssembly
from advisor.oem.descent import Response, descended
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Prior as Width
from advisor.oem.gauss_newton import weigh
from advisor.oem.prior import Priors
from advisor.process.arrays import FloatArray

MOST = 40
"""Numerical: largest number of trial steps of a fit; a fit from a tabulated start takes three to six."""
SETTLED = 0.05
"""Numerical: decrease of -2 log likelihood over the temperature, in one step, below which a fit has
converged: far below one nat."""


class Flying(NamedTuple):
    """Records under one setting of servos and instruments, as a problem of the search."""

    flown: Flown
    setting: Setting

    def at(self, place: Place) -> float:
        """Return the value at a place; an absent one is zero."""
        return float(self.setting[place][0]) if place in self.setting else 0.0

    def having(self, place: Place, value: float) -> "Flying":
        """Return the records with another value at a place."""
        return Flying(self.flown, moved_to(self.setting, [place], np.array([value])))


@dataclass(frozen=True, slots=True)
class Known:
    """Gaussian prior of derivatives and effect parameters."""

    mean: FloatArray
    precision: FloatArray
    """Shape (s + k,): inverse prior variances."""

    def prior(self, values: FloatArray) -> Prior:
        """Return the prior relative to the values (s + k,) of a fit."""
        return Prior(self.precision, self.mean - values)

    def height(self, fit: "Fit") -> float:
        """Return the log posterior density of a fit, up to a constant."""
        return fit.likelihood - 0.5 * float(self.precision @ (fit.values - self.mean) ** 2)


class Begun(NamedTuple):
    """First event of each record."""

    t: FloatArray
    """(m,) s"""
    rates: FloatArray
    """Shape (m, n): rates of the states there."""


class Point(NamedTuple):
    """Parameters of a fit: derivatives, effect parameters and local parameters."""

    theta: FloatArray
    """(s,)"""
    local: FloatArray
    """Shape (m, l): trims, initial states and biases of each manoeuvre."""
    setting: Setting


@dataclass(frozen=True, slots=True)
class Fit:
    """Optimum of one model's fit."""

    point: Point
    assembly: AxisAssembly
    free: tuple[Parameter, ...]
    fitted: FloatArray
    """Shape (N,): simulated outputs at the optimum."""
    noise: FloatArray
    """(outputs,)"""
    likelihood: float
    """Log likelihood for white noise, up to a constant."""
    columns: FloatArray
    """Shape (N, s + k): sensitivities to shared parameters, without what trims, initial states and biases
    absorb."""
    slopes: FloatArray
    """Shape (N, k): derivatives of the outputs by the effect parameters."""
    sensitivities: FloatArray
    """Shape (N, s + l): derivatives of the outputs by the aerodynamic derivatives and the local
    parameters."""
    begun: Begun

    @property
    def values(self) -> FloatArray:
        """Shape (s + k,): values of the derivatives and of the effect parameters."""
        setting = self.point.setting
        return np.array(
            [*self.point.theta, *(setting[f.place][0] if f.place in setting else 0.0 for f in self.free)]
        )

    @property
    def added(self) -> FloatArray:
        """Shape (N,): part of the outputs by nonlinear terms, which the simulation lacks."""
        at = zip(self.free, self.values[len(self.point.theta) :], strict=True)
        return sum((v * f.column for f, v in at if f.adds), np.zeros(len(self.fitted)))

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values, (s + k,) each."""
        low, high = np.array([(-np.inf, np.inf)] * len(self.point.theta) + [f.bounds for f in self.free]).T
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
    flown: Flown, begin: Point, free: Sequence[Parameter], prior_known: Known, share: float = 1.0
) -> Fit | None:
    """Return the optimum from a start; None if the simulation diverges.

    One nat of the white-noise likelihood counts as ``share``² nats.
    """
    std, n = prior_known.precision**-0.5, len(begin.theta)
    priors = zip(prior_known.mean[n:].tolist(), std[n:].tolist(), strict=True)
    widths = [replace(f, prior=Width(*each)) for f, each in zip(free, priors, strict=True)]
    prior, place = Priors(prior_known.mean[:n], std[:n]), (begin.theta, begin.local)
    descent = descended(
        _Motion(flown.axis.names),
        Flying(flown, begin.setting),
        widths,
        prior,
        place,
        MOST,
        SETTLED / share**2,
    )
    if isinstance(descent, NoEstimate):
        return None
    return _as_fit(Point(*descent.place, descent.problem.setting), descent.assembly, descent.response, free)


def moved_by(flown: Flown, fit: Fit, change: FloatArray) -> Fit | None:
    """Return a fit after a change (s + k,) of derivatives and effect parameters.

    Trims, initial states and biases follow the change. None if the simulation diverges.
    """
    n = len(fit.point.theta)
    columns = np.column_stack([fit.sensitivities[:, :n], fit.slopes])
    left = (fit.residual - columns @ change) * fit.weight
    local, own = fit.point.local.copy(), fit.assembly.own
    for m, rows in enumerate(fit.assembly.blocks):
        mine = fit.sensitivities[rows][:, own] * fit.weight[rows, None]
        local[m, own - n] += np.linalg.lstsq(mine, left[rows], rcond=None)[0]
    places = [f.place for f in fit.free]
    setting = moved_to(fit.point.setting, places, (fit.values + change)[n:])
    point, assembly = Point(fit.point.theta + change[:n], local, setting), laid_out(flown, setting)
    response = _Motion(flown.axis.names).respond(
        Flying(flown, setting), assembly, point.theta, local, fit.free
    )
    return None if response is None else _as_fit(point, assembly, response, fit.free)


@dataclass(frozen=True, slots=True)
class _Motion:
    """Simulated response under a setting, for the search of the estimates."""

    names: Names

    def laid(self, problem: Flying, /) -> AxisAssembly:
        """Return the measurements as stacked rows."""
        return laid_out(*problem)

    def floor(self, laid: AxisAssembly, /) -> FloatArray:
        """Return the least standard deviation of each output, SI."""
        return laid.least

    def begins(self, laid: AxisAssembly, /) -> FloatArray:
        """Return the time of the first event of each record, s."""
        return laid.begin

    def respond(
        self,
        problem: Flying,
        laid: AxisAssembly,
        theta: FloatArray,
        local: FloatArray,
        free: Sequence[Parameter],
        /,
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""
        simulated = simulate(laid, theta, local)
        if simulated is None:
            return None
        setting, motion = problem.setting, simulated[2]
        y, g = (filtered(laid, setting, raw) for raw in simulated[:2])
        rates = motion[laid.grid.first[:-1], 1]
        begun = Begun(laid.begin, rates)
        added = sum(f.read(problem) * f.column for f in free if f.adds and f.column is not None)

        def slope(f: Parameter) -> FloatArray:
            if f.column is not None:
                return f.column
            if f.place[0].partition("@")[0] in laid.axis.changes:
                return column_of_change(problem.flown, setting, f.place, theta, g, laid.owner)
            column = column_of(f.place, problem.at(f.place), laid, local, simulated)
            return (
                _by_difference(f, problem, Point(theta, local, setting), y, begun)
                if column is None
                else filtered(laid, setting, column)
            )

        def columns() -> FloatArray:
            return np.array([slope(f) for f in free]).reshape(-1, len(y)).T

        return Response(y + added, g[:, : laid.axis.count], columns, rates)


def _by_difference(f: Parameter, problem: Flying, point: Point, y: FloatArray, begun: Begun) -> FloatArray:
    """Return the derivative (N,) of the outputs by an effect that bends the motion, by a difference."""
    value = problem.at(f.place)
    step = f.step if value + f.step <= f.bounds[1] else -f.step
    setting = moved_to(problem.setting, [f.place], np.array([value + step]))
    return (outputs(problem.flown, point._replace(setting=setting), begun) - y) / step


def _as_fit(point: Point, assembly: AxisAssembly, response: Response, free: Sequence[Parameter]) -> Fit:
    """Return a fit with its sensitivities, without what local parameters absorb.

    The columns of derivatives that the flight does not show are zero.
    """
    n = len(point.theta)
    noise, cost = weigh(assembly.z, response.y, assembly.channel, assembly.least)
    begun = Begun(assembly.begin, response.begun)
    slopes, weight = response.columns(), 1.0 / noise[assembly.channel]
    columns = np.column_stack([response.g[:, :n], slopes])
    for rows in assembly.blocks:
        columns[rows] = unabsorbed(columns[rows], response.g[rows][:, assembly.own], weight[rows])
    columns[:, [k for k in range(n) if k not in assembly.free]] = 0.0
    return Fit(
        point, assembly, tuple(free), response.y, noise, -0.5 * cost, columns, slopes, response.g, begun
    )


def outputs(flown: Flown, point: Point, begun: Begun | None = None) -> FloatArray:
    """Return the simulated outputs (N,) at a point of the parameters.

    Parameters
    ----------
    begun
        Begin of each record at which the point's initial states hold. A delay may move the first event.
    """
    laid, local = laid_out(flown, point.setting), point.local
    if begun is not None:
        local = local.copy()
        initial = np.array(laid.axis.initial) - len(laid.axis.shared)
        local[:, initial] += (laid.begin - begun.t)[:, None] * begun.rates
    return filtered(laid, point.setting, outputs_of(laid, point.theta, local))
