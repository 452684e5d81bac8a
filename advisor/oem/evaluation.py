"""Evaluation of an optimum: influence of the measurements, colour of the noise, and errors."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.oem.covariance import Coloured, Influence, coloured, colours_of, cramer_rao, influence, widening
from advisor.oem.extra import Extra
from advisor.oem.gauss_newton import Optimum
from advisor.oem.model_error import model_error
from advisor.oem.rows import Laid
from advisor.oem.scatter_between import widened_by_scatter
from advisor.process.arrays import FloatArray

LEAST_SHARE = 0.01
"""Least factor on a prior's standard deviation in a white-noise fit; data without noise have no colour."""


def share_of(white: FloatArray, stated: FloatArray) -> float:
    """Return the median ratio of the parameters' errors under white noise to their stated errors.

    ``white`` and ``stated`` are covariances (k, k). Parameters without error do not count.
    """
    variance = np.diag(stated)
    moving = variance > 0.0
    ratio = np.sqrt(np.diag(white)[moving] / variance[moving])
    return float(np.clip(np.median(ratio), LEAST_SHARE, 1.0)) if len(ratio) else 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluated:
    """An optimum with all derived quantities, for p reported and k extra parameters."""

    optimum: Optimum
    influence: Influence
    theta: FloatArray
    """Shape (p,): reported parameters; a manoeuvre's own parameters are averaged over the manoeuvres."""
    covariance_cr: FloatArray
    """Shape (p + k, p + k): Cramér-Rao bound of the reported and of the extra parameters."""
    covariance: FloatArray
    """Shape (p + k, p + k): covariance from the noise within the manoeuvres, for coloured residuals."""
    noise: Coloured
    """Colour of each output's noise."""
    contributions: FloatArray
    """Shape (m, p + k): contribution of each manoeuvre's residuals to each parameter, with zero sum."""
    systematic: FloatArray
    """Shape (p + k, p + k): covariance from dynamics that the model lacks, equal in all manoeuvres."""
    modes: FloatArray | None = None
    """Shape (p + k, p + k): second moment of another posterior mode about this one, times its probability."""
    extra: Extra | None = None
    """Additional parameters, such as step times; the number e is at least k."""

    @property
    def fitted(self) -> FloatArray:
        """Shape (N,): model outputs, in the rows of the measurements."""
        return self.optimum.fitted

    @property
    def sensitivities(self) -> FloatArray:
        """Shape (N, s + l): derivatives of the outputs by the parameters of the row's manoeuvre."""
        return self.optimum.sensitivities

    @property
    def scattered(self) -> FloatArray:
        """Shape (p + k, p + k): covariance that includes the scatter between the manoeuvres."""
        return widened_by_scatter(self.covariance, self.contributions[:, : len(self.covariance)])

    @property
    def widened(self) -> FloatArray:
        """Shape (p + k, p + k): covariance that also includes another mode and errors common to all
        manoeuvres."""
        size = len(self.covariance)
        total = self.scattered + self.systematic[:size, :size]
        return np.asarray(total if self.modes is None else total + self.modes[:size, :size])


def errors_of(
    assembly: Laid,
    residual: FloatArray,
    g: FloatArray,
    weights: FloatArray,
    extra: Extra | None,
    prior: FloatArray,
    *,
    fitted: FloatArray | None = None,
    prior_share: float | None = None,
    kept: int | None = None,
) -> dict[str, Any] | None:
    """Return the fields of ``Evaluated`` that hold errors; None on numerical overflow.

    Parameters
    ----------
    residual
        Shape (N,): measured minus fitted outputs.
    g
        Shape (N, s + l): derivatives of the outputs.
    weights
        Shape (outputs,): standard deviation with which the fit weights each output.
    extra, prior
        Arguments of ``covariance.influence``.
    fitted
        Shape (N,): outputs of the model. None if the rows are innovations, in which common dynamics do not
        stand out.
    prior_share
        Factor on the standard deviation of ``prior`` in a white-noise fit, as in ``rows.Prior``. None if the
        prior has no error.
    kept
        Number of the first extra parameters that get errors; by default all.
    """
    effect = influence(assembly, g, weights, extra, prior)
    if effect is None:
        return None
    if kept is not None:
        effect = effect.first(len(assembly.names.reported) + kept)
    from_priors = effect.prior_covariance
    if prior_share is not None:
        pulled = effect.shared_inverse * (np.sqrt(prior) / prior_share)[assembly.common, None]
        from_priors = pulled.T @ pulled + from_priors
    colours = colours_of(assembly, residual, g)
    noise = Coloured(colours, widening(assembly, effect.rows, colours))
    systematic = np.zeros((effect.rows.shape[1],) * 2)
    if fitted is not None:
        systematic = model_error(assembly, fitted, residual, g, extra, noise.colours, effect.rows)
    return {
        "influence": effect,
        "noise": noise,
        "covariance_cr": cramer_rao(assembly, effect.rows, weights) + from_priors,
        "covariance": coloured(assembly, effect.rows, noise) + from_priors,
        "contributions": contributions_of(assembly, effect.rows, residual),
        "systematic": systematic,
    }


def contributions_of(assembly: Laid, rows: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the contribution of each manoeuvre, shape (m, p + k), from influence ``rows`` (N, p + k) and
    ``residual`` (N,)."""
    pull = rows * residual[:, None]
    return np.array([pull[block].sum(axis=0) for block in assembly.blocks])
