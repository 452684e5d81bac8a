"""The evaluation of an optimum: influence of every measurement, colour of the noise, and errors."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.oem.covariance import Coloured, Influence, coloured, colours_of, cramer_rao, influence, widening
from advisor.oem.extra import Extra
from advisor.oem.gauss_newton import Optimum
from advisor.oem.model_error import model_error
from advisor.oem.rows import Laid
from advisor.oem.scatter_between import widened_by_scatter


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluated:
    """An optimum with all quantities computed from it. p parameters are reported, k are extra ones."""

    optimum: Optimum
    influence: Influence
    theta: FloatArray
    """(p,) reported parameters; those of one manoeuvre are means over the manoeuvres."""
    covariance_cr: FloatArray
    """(p + k, p + k) Cramér-Rao bound of the reported and of the extra parameters."""
    covariance: FloatArray
    """(p + k, p + k) covariance by the noise within the manoeuvres, corrected for coloured residuals."""
    noise: Coloured
    """Colour of each output's noise."""
    contributions: FloatArray
    """(m, p + k) contribution of each manoeuvre's residuals to each parameter; they sum to zero."""
    systematic: FloatArray
    """(p + k, p + k) covariance by dynamics that the model lacks, alike in all manoeuvres."""
    modes: FloatArray | None = None
    """(p + k, p + k) second moment of another mode of the posterior about this one, by its probability."""
    extra: Extra | None = None
    """Additional parameters, such as the times of edges: e of them, at least k."""

    @property
    def fitted(self) -> FloatArray:
        """(N,) model outputs, in the rows of the measurements."""
        return self.optimum.fitted

    @property
    def sensitivities(self) -> FloatArray:
        """(N, s + l) derivatives of the outputs by the parameters of the row's manoeuvre."""
        return self.optimum.sensitivities

    @property
    def scattered(self) -> FloatArray:
        """(p + k, p + k) covariance that contains the scatter between the manoeuvres."""
        return widened_by_scatter(self.covariance, self.contributions[:, : len(self.covariance)])

    @property
    def widened(self) -> FloatArray:
        """(p + k, p + k) covariance that also has another mode, and errors that all manoeuvres have alike."""
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
    noise: Coloured | None = None,
    kept: int | None = None,
) -> dict[str, Any] | None:
    """Return the fields of ``Evaluated`` that hold errors; None where numbers overflow.

    Parameters
    ----------
    residual
        (N,) measured minus fitted outputs.
    g
        (N, s + l) derivatives of the outputs.
    weights
        (outputs,) standard deviation of each output by which the fit weighs it.
    extra, prior
        Arguments of ``covariance.influence``.
    fitted
        (N,) outputs of the model. None: rows are innovations, in which common dynamics do not stand out.
    prior_share
        Share by which white noise weighs ``prior``, as in ``extra.Prior``, where its error is part of the
        covariance. None: the prior has no error.
    noise
        Noise model that is used instead of a new fit.
    kept
        Number of extra parameters, the first ones, with errors of their own; by default all.
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
    if noise is None:
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
