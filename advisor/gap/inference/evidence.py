"""Marginal likelihood of a fitted model (Laplace), with each derivative of the file right or wrong.

Near a fit the log likelihood is quadratic, so the integral over all parameters has a closed form. The
residual of even the best simulator is coloured, and similar in all manoeuvres. One nat of white-noise
likelihood therefore counts as 1/``temperature`` nats.
"""

from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG, prior_precision
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.fitting.uncertainty import colour_of
from advisor.gap.inference.explanation import Evidence
from advisor.gap.inference.marginal import Prior, marginal
from advisor.process.arrays import FloatArray

_UNSTATED = 1.0
"""Prior: relative standard deviation of a derivative that the aircraft file does not state."""


@dataclass(frozen=True)
class FlightProblem(EffectProblem):
    """A flight together with the tolerance of the simulator's derivatives."""

    tolerance: float = ERROR_IF_WRONG
    """Relative standard deviation of the file's derivatives in a fit."""
    centre: FloatArray | None = None
    """Shape (6,): mean of the derivatives' prior where no file states them."""

    @classmethod
    def of(cls, plain: EffectProblem, fitted: EffectFit) -> "FlightProblem":
        """Return the problem whose prior is centred at the plain fit's derivatives if the file states
        none."""
        fields = {name: getattr(plain, name) for name in EffectProblem.__dataclass_fields__}
        return cls(**fields, centre=fitted.point.derivatives)

    @property
    def is_stated(self) -> bool:
        """Whether the aircraft file states all derivatives."""
        return self.prior_derivatives is not None

    @property
    def mean(self) -> FloatArray:
        """Shape (6,): prior mean of the derivatives."""
        mean = self.prior_derivatives if self.prior_derivatives is not None else self.centre
        assert mean is not None
        return mean

    def within(self, tolerance: float) -> "FlightProblem":
        """Return the problem with another relative standard deviation of the file's derivatives."""
        return replace(self, tolerance=tolerance)

    def prior_of(self, point: SearchPoint) -> tuple[FloatArray, FloatArray]:
        """Return inverse prior variances of the shared parameters, and prior mean minus values, shapes
        (k,)."""
        return self.prior_with(point, self.tolerance if self.is_stated else _UNSTATED)

    def prior_with(self, point: SearchPoint, width: float) -> tuple[FloatArray, FloatArray]:
        """Return inverse prior variances and prior mean minus values for a relative error ``width`` of the
        derivatives."""
        return self.prior_about(point, prior_precision(self.mean, width), self.mean)


def temperature(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return the number of white-noise nats that count as one nat, at least 1.

    Coloured residuals contain fewer independent samples. Power above the known noise is a misfit that all
    manoeuvres share, so all manoeuvres count as one.
    """
    power = float(np.mean(fitted.noise**2)) if problem.knows_the_noise else 1.0
    shared = max(0.0, 1.0 - 1.0 / max(power, 1e-9))
    return colour_of(problem, fitted) * (1.0 + shared * (len(problem.flights) - 1))


def log_likelihood(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return the log likelihood of a fit, profiled over the noise, up to a constant."""
    return -0.5 * (fitted.cost - problem.prior_cost(fitted.point))


def evidence_of(
    problem: FlightProblem, fitted: EffectFit, heat: float, narrower: FloatArray | None = None
) -> Evidence:
    """Return the evidence of a model; ``problem`` is the problem to which the model was fitted.

    At the fit the gradient of the log likelihood balances that of the fit's prior.

    Parameters
    ----------
    narrower
        Shape (numbers,): factors on the prior widths of the effect that was added last; None for the widths
        themselves.
    """
    precision, pull = problem.prior_of(fitted.point)
    widths = (ERROR_IF_RIGHT, ERROR_IF_WRONG) if problem.is_stated else (_UNSTATED, _UNSTATED)
    priors = [Prior(*problem.prior_with(fitted.point, width)) for width in widths]
    if narrower is not None:
        for prior in priors:
            prior.precision[fitted.point.place(len(fitted.point.effects) - 1)] /= narrower**2
    return marginal(
        log_likelihood(problem, fitted) / heat,
        (fitted.information - np.diag(precision)) / heat,
        -precision * pull / heat,
        *priors,
    )
