"""Uncertainty of a fit's shared parameters under coloured residuals."""

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.fitting.step import own_eliminated
from advisor.gap.records.floor import effective_sample_size
from advisor.oem.arrow import inverse_of
from advisor.oem.scatter_between import widened_by_scatter
from advisor.process.arrays import FloatArray


def colour_of(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return the number of innovation samples per independent sample, at least 1."""
    effective = sum(
        effective_sample_size(residual[rows])
        for flight, residual in zip(problem.flights.flights, fitted.innovations, strict=True)
        for rows in problem.rows(flight)
    )
    return max(float(np.sum(counts(problem))) / max(effective, 1.0), 1.0)


def covariance_of(problem: EffectProblem, fitted: EffectFit, heat: float) -> FloatArray:
    """Return the posterior covariance of the shared parameters, with the scatter between manoeuvres, shape
    (k, k).

    Parameters
    ----------
    heat
        Number of nats of white-noise likelihood that count as one nat.
    """
    precision, _ = problem.prior_of(fitted.point)
    information = (fitted.information - np.diag(precision)) / heat + np.diag(precision)
    pulls = np.array([own_eliminated(block, 1.0 / fitted.noise)[0][:-1, -1] for block in fitted.linear])
    return widened_by_scatter(inverse_of(information)[0], pulls @ inverse_of(fitted.information)[0])
