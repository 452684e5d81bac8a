"""The efficient estimate where the noise is coloured: one whitened Gauss-Newton step from the optimum.

Output error weighs every sample alike. Where the noise remembers, generalised least squares has the
smaller error: residuals and sensitivities pass through the filter that whitens the noise, and from there on
all is as with white noise. From an estimate as good as output error's, one step reaches the Cramér-Rao
bound of an estimator that is told the colour (Lehmann & Casella, *Theory of Point Estimation*, theorem
6.4.3). Lowest J, Eq. (7), and smallest error are then two different points.

What is slow in a residual is not always noise. A servo's lag, a late angle of attack and moving air are slow,
too, and an estimator that discounts the slow part trusts the fast part, where errors of timing live. So
the step is taken only where it gains something and the record is nothing but model and such noise:

- whitened, no output's residual remembers anything (Ljung & Box, *Biometrika* 65, 1978);
- the step is no longer than right models let it be (Hausman, *Econometrica* 46, 1978).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.oem.colour import moved
from advisor.oem.covariance import DIFFERENCE, Coloured, coloured, widening
from advisor.oem.solution import Solution
from advisor.oem.weighing import Weighing

N = len(PARAMETERS)
LAGS = 20
"""Samples over which a whitened residual must not remember."""
CHANCE = 0.01
"""Of refusing where the noise is what it seems, over all tests."""
GAIN = 0.02
"""Least relative decrease of some parameter's variance that is worth a step."""
LEAST_SHARE = 0.01
"""Variance of the step as a share of the estimate's, below which round-off would decide a test of it."""


@dataclass(frozen=True, slots=True)
class Step:
    """From the lowest cost to the smallest error."""

    change: FloatArray
    """(8,) of the parameters."""
    covariance: FloatArray
    """(8, 8) of the parameters after it, widened for not knowing the colours exactly."""
    gain: float
    """Largest relative decrease of a parameter's variance."""
    chances: FloatArray
    """Chance, were all noise of these colours, of each output's whitened residual remembering as much as
    it does, and of a step as long as this."""


def efficient(solution: Solution) -> Solution:
    """Return the solution with the efficient values and errors of the eight, or itself.

    Cost, fit and all else stay those of output error.
    """
    colours = solution.noise.colours.values()
    if all(c.memory == 0.0 for c in colours) or any(c.variance == 0.0 for c in colours):
        return solution
    step = efficient_step(solution)
    if step is None or step.gain < GAIN or np.min(step.chances) < CHANCE / len(step.chances):
        return solution
    return replace(solution, theta=solution.theta + step.change, covariance=step.covariance)


def efficient_step(solution: Solution) -> Step | None:
    """Return the step and what speaks for it; None when it overflows."""
    colours, assembly = solution.noise.colours, solution.assembly
    weighing = Weighing.by(solution.noise, assembly)
    found = weighing.influence(solution.sensitivities, solution.extra)
    if found is None:
        return None
    rows, plain = found[:, :N], solution.influence.rows[:, :N]
    exact = Coloured(colours, np.ones(N))
    before, after = coloured(assembly, plain, exact), coloured(assembly, rows, exact)
    change: FloatArray = rows.T @ solution.residual
    covariance = coloured(assembly, rows, Coloured(colours, widening(assembly, rows, colours)))
    long = _chance(change, coloured(assembly, rows - plain, exact), np.sqrt(np.diag(after)))
    return Step(
        change=change,
        covariance=covariance + 2.0 * _unsure(solution, change),
        gain=float(np.max(1.0 - np.diag(after) / np.diag(before))),
        chances=np.array([*_remembering(solution, weighing), long]),
    )


def _unsure(solution: Solution, change: FloatArray) -> FloatArray:
    """Return (8, 8) covariance of the step for not knowing the colours, by which it is weighed, exactly.

    The estimate's covariance is larger by it than with known colours, and the usual formula with estimated
    ones smaller: it counts twice (Kenward & Roger, *Biometrics* 53, 1997).
    """
    total = np.zeros((N, N))
    for output, colour in solution.noise.colours.items():
        slopes = np.zeros((len(colour.uncertainty), N))
        for i in range(len(slopes)):
            step = np.zeros(3)
            step[i] = DIFFERENCE
            other = {**solution.noise.colours, output: moved(colour, step)}
            weighing = Weighing.by(Coloured(other, np.ones(N)), solution.assembly)
            rows = weighing.influence(solution.sensitivities, solution.extra)
            if rows is not None:
                slopes[i] = (rows[:, :N].T @ solution.residual - change) / DIFFERENCE
        total += slopes.T @ colour.uncertainty @ slopes
    return total


def _chance(change: FloatArray, covariance: FloatArray, unit: FloatArray) -> float:
    """Return chance that a change of this covariance is as long as this one, both in units of ``unit``
    (8,)."""
    values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    along = vectors.T @ (change / unit)
    return float(chdtrc(len(change), np.sum(along**2 / np.maximum(values, LEAST_SHARE))))


def _remembering(solution: Solution, weighing: Weighing) -> list[float]:
    """For each output the chance that white noise seems to remember as much as its whitened residual.

    An output of few samples has no say.
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
