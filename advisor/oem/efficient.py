"""Efficient estimate with coloured noise: one whitened Gauss-Newton step from the optimum.

Output error gives all samples equal weight. With coloured noise generalised least squares has a smaller
error, because a filter whitens residuals and sensitivities. From an output-error estimate, one step reaches
the Cramér-Rao bound for known noise. The source is Lehmann & Casella, *Theory of Point Estimation*, theorem
6.4.3. The least cost J of Eq. (7) and the smallest error then lie at different parameter values.

A slow residual is not always noise. A servo lag, a late angle of attack and moving air also cause slow
residuals. An estimator that discounts slow residuals relies on fast ones, where timing errors matter. The
step is therefore taken only if it reduces a variance and the residual is coloured noise:

- after whitening, no output's residual is correlated (Ljung & Box, *Biometrika* 65, 1978);
- the step is no longer than a right model allows (Hausman, *Econometrica* 46, 1978).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from advisor.aircraft.reference import PARAMETERS
from advisor.oem.colour import moved
from advisor.oem.covariance import DIFFERENCE, Coloured, coloured, widening
from advisor.oem.model_error import model_error
from advisor.oem.solution import Solution
from advisor.oem.weighing import Weighing
from advisor.process.arrays import FloatArray

N = len(PARAMETERS)
LAGS = 20
"""Number of lags over which a whitened residual must be uncorrelated."""
CHANCE = 0.01
"""Probability that a valid step is refused by chance, over all tests."""
GAIN = 0.02
"""Least relative decrease of a parameter's variance for which the step is taken."""
LEAST_SHARE = 0.01
"""Ratio of the step's variance to the estimate's variance, below which rounding errors dominate. Such a step
is not tested."""


@dataclass(frozen=True, slots=True)
class Step:
    """Step from the optimum of output error to the efficient estimate."""

    change: FloatArray
    """Shape (8,): change of the eight parameters by the step."""
    covariance: FloatArray
    """Shape (8, 8): covariance after the step, including the noise model's uncertainty."""
    systematic: FloatArray
    """Shape (8, 8): covariance after the step from dynamics that the model lacks."""
    gain: float
    """Largest relative decrease of a parameter's variance."""
    chances: FloatArray
    """Chance probabilities of each output's whitened autocorrelation and of the step's length."""


def efficient(solution: Solution) -> Solution:
    """Return the solution with the efficient values and errors of the eight parameters, if the step is valid.

    Cost and fit stay those of output error.
    """
    colours = solution.noise.colours.values()
    if all(c.memory == 0.0 for c in colours) or any(c.variance == 0.0 for c in colours):
        return solution
    step = efficient_step(solution)
    if step is None or step.gain < GAIN or np.min(step.chances) < CHANCE / len(step.chances):
        return solution
    return replace(
        solution, theta=solution.theta + step.change, covariance=step.covariance, systematic=step.systematic
    )


def efficient_step(solution: Solution) -> Step | None:
    """Return the efficient step with the probabilities of its tests; None on numerical overflow."""
    colours, assembly = solution.noise.colours, solution.assembly
    weighing = Weighing.by(colours, assembly)
    influence = weighing.influence(solution.sensitivities, solution.extra)
    if influence is None:
        return None
    best, usual = influence.first(N), solution.influence.first(N)
    rows, plain = best.rows, usual.rows
    exact = Coloured(colours, np.ones(N))
    before = coloured(assembly, plain, exact) + usual.prior_covariance
    after = coloured(assembly, rows, exact) + best.prior_covariance
    change = best.step(solution.residual, solution.extra)
    wide = Coloured(colours, widening(assembly, rows, colours))
    covariance = coloured(assembly, rows, wide) + best.prior_covariance
    pulled = best.prior_rows - usual.prior_rows
    apart = coloured(assembly, rows - plain, exact) + pulled.T @ pulled
    systematic = model_error(
        assembly, solution.fitted, solution.residual, solution.sensitivities, solution.extra, colours, rows
    )
    moving = np.diag(before) > 0.0  # a fixed parameter has no error
    long = _chance(change[moving], apart[np.ix_(moving, moving)], np.sqrt(np.diag(after)[moving]))
    return Step(
        change=change,
        covariance=covariance + 2.0 * _unsure(solution, change),
        systematic=systematic,
        gain=float(np.max(1.0 - np.diag(after)[moving] / np.diag(before)[moving])),
        chances=np.array([*_remembering(solution, weighing), long]),
    )


def _unsure(solution: Solution, change: FloatArray) -> FloatArray:
    """Return the step's covariance due to the noise model's uncertainty, shape (8, 8).

    The estimate's covariance is larger by this term than with a known noise model. The usual formula is too
    small by this term again. The term therefore counts twice (Kenward & Roger, *Biometrics* 53, 1997).
    """
    total = np.zeros((N, N))
    for output, colour in solution.noise.colours.items():
        slopes = np.zeros((len(colour.uncertainty), N))
        for i in range(len(slopes)):
            step = np.zeros(3)
            step[i] = DIFFERENCE
            other = {**solution.noise.colours, output: moved(colour, step)}
            weighing = Weighing.by(other, solution.assembly)
            there = weighing.influence(solution.sensitivities, solution.extra)
            if there is not None:
                other_change = there.first(N).step(solution.residual, solution.extra)
                slopes[i] = (other_change - change) / DIFFERENCE
        total += slopes.T @ colour.uncertainty @ slopes
    return total


def _chance(change: FloatArray, covariance: FloatArray, unit: FloatArray) -> float:
    """Return the probability of a step at least this long under its covariance, in ``unit`` (8,)."""
    values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    along = vectors.T @ (change / unit)
    return float(chdtrc(len(change), np.sum(along**2 / np.maximum(values, LEAST_SHARE))))


def _remembering(solution: Solution, weighing: Weighing) -> list[float]:
    """Return the probability that white noise has an equal whitened autocorrelation, for each output.

    An output with few samples is not tested.
    """
    white = weighing.forward(solution.residual[:, None])[:, 0]
    lags = np.arange(1, LAGS + 1)
    chances = []
    for output in solution.noise.colours:
        stretches = [white[named[output]] for named in solution.assembly.rows if output in named]
        samples = sum(len(e) for e in stretches)
        if samples <= 2 * LAGS:
            continue
        products = [sum(float(e[lag:] @ e[:-lag]) for e in stretches) for lag in lags]
        correlation = np.array(products) / sum(float(e @ e) for e in stretches)
        statistic = samples * (samples + 2) * float(np.sum(correlation**2 / (samples - lags)))
        chances.append(float(chdtrc(LAGS, statistic)))
    return chances
