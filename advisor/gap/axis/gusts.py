"""Gusts in the residuals of a fit, distinguished from coloured noise of the instruments.

The likelihood of the residuals is that of the estimates' errors (``oem.axis.gusts``).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.axis.fit import Fit, Known
from advisor.oem.arrow import solved_within
from advisor.oem.axis.disturbance import Course
from advisor.oem.axis.gusts import Air, Integrated, Sums, likeliest
from advisor.oem.covariance import colours_of
from advisor.oem.weighing import Weighing
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Gusts:
    """White noise of the outputs and the gust angle's statistics, as estimated from the residuals."""

    air: Air
    angle_std: float
    """Standard error of the gust angle's standard deviation, rad, with the gusts' memory free."""
    likelihood: float
    """Log likelihood of the residuals, on the scale of ``Fit.likelihood``."""
    matrix: FloatArray
    """Shape (k, k): information about derivatives and effect parameters under gust-coloured residuals."""
    gradient: FloatArray
    """Shape (k,): gradient of the log likelihood at the fit."""

    def change(self, prior: Known, fit: Fit) -> FloatArray:
        """Return the change (k,) from the fit to the optimum with gusts and prior, within the bounds."""
        low, high = fit.bounds
        pull = self.gradient + prior.precision * (prior.mean - fit.values)
        whole = self.matrix + np.diag(prior.precision)
        return solved_within(whole, pull, low - fit.values, high - fit.values)

    def height(self, prior: Known, fit: Fit) -> float:
        """Return the log posterior density of the fit with these gusts, up to a constant."""
        return self.likelihood - 0.5 * float(prior.precision @ (fit.values - prior.mean) ** 2)

    def at(self, fit: Fit, courses: Sequence[Course]) -> "Gusts":
        """Return gusts with unchanged statistics, with the likelihood and its slopes at another fit."""
        volume, inner = self.air.weighed(_sums(fit, courses))
        likelihood = -0.5 * (volume + float(inner[0, 0]) - len(fit.fitted))
        return replace(self, likelihood=likelihood, matrix=inner[1:, 1:], gradient=inner[1:, 0])


def gusts_of(fit: Fit, courses: Sequence[Course], values_prior: Known, near: Gusts | None = None) -> Gusts:
    """Return the likeliest white noise and gusts in the residuals of a fit.

    Derivatives and effect parameters are integrated out, because a white-noise fit has absorbed part of the
    gusts.

    Parameters
    ----------
    values_prior
        Prior of derivatives and effect parameters.
    near
        Gusts of a similar fit, at which the search begins.
    """
    sums, prior = _sums(fit, courses), Integrated(*values_prior.prior(fit.values))
    air = likeliest(sums, fit.noise, prior, None if near is None else near.air)
    return Gusts(air, air.angle_std(sums, prior), np.nan, *np.empty((2, 0, 0))).at(fit, courses)


def coloured_likelihood(fit: Fit) -> float:
    """Return the residuals' log likelihood with coloured noise in each instrument, on the scale of
    ``Fit.likelihood``."""
    colours = colours_of(fit.assembly, fit.residual, np.ones_like(fit.sensitivities))
    weighing = Weighing.by(colours, fit.assembly)
    power = float(np.sum(weighing.forward(fit.residual[:, None]) ** 2))
    return -0.5 * (weighing.volume + power - len(fit.fitted))


def _sums(fit: Fit, courses: Sequence[Course]) -> list[Sums]:
    """Return the inner products of every manoeuvre, of residual and shared parameters."""
    columns, laid = np.column_stack([fit.residual, fit.columns]), fit.assembly
    pairs = zip(courses, laid.blocks, strict=True)
    return [Sums.of(laid.channel[rows], len(fit.noise), columns[rows], course) for course, rows in pairs]
