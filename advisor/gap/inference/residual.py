"""Residual of a model: the disturbance in each block that explains most of the residual."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.quiet import probe_blocks
from advisor.gap.records.floor import tolerance_of
from advisor.process.arrays import FloatArray

_HARDLY = 1e-6
"""Numerical: probability below which a block counts as excluded."""
NATURAL = 0.004
"""Prior: motion that even a right simulator leaves unexplained, as a share of a channel's peak."""
_RIGHT, _LACKING = (0.0, 0.6), (np.log(3.0), 0.9)
"""Prior: mean and standard deviation of the log of the residual's size (``Residual.size``), of a right model
and of one that lacks a law."""
MOST_NATS = -float(np.log(min(_RIGHT[1], _LACKING[1])))
"""Numerical: largest log density, nats, of a residual's size."""
_LEAST_MISFIT = 0.25
"""Numerical: size of a residual below which the residual counts as zero."""


@dataclass(frozen=True)
class Residual:
    """Motion that a model does not explain, beyond noise."""

    size: float
    """Size of the motion that the likeliest disturbance explains, over the residual natural to every
    simulator. The size is that of the channel with the largest ratio."""
    blocks: Mapping[str, float]
    """Probability of each block, given that an effect without a name acts in one block."""
    size_beside_air: float | None = None
    """Size of the motion that moving air does not explain; None where the models contain no air."""
    error: float = 0.0
    """Standard error of the squared size; 0 where the size has no scatter."""
    freedom: int = 0
    """Degrees of freedom of the standard error."""

    @property
    def beside_air(self) -> float:
        """Size of the residual beyond moving air."""
        return self.size if self.size_beside_air is None else self.size_beside_air

    def nats(self, in_moving_air: bool) -> tuple[float, float]:
        """Return the log densities, nats, of the size where the model is right, and where it lacks a law."""
        size = self.beside_air if in_moving_air else self.size
        error = self.error * (size / self.size) ** 2 if self.size > 0.0 else self.error
        return _density(size, error, self.freedom, _RIGHT), _density(size, error, self.freedom, _LACKING)


def residual_of(problem: EffectProblem, fitted: EffectFit, heat: float) -> Residual:
    """Return the disturbance that explains the residual of a fit.

    Parameters
    ----------
    heat
        Number of white-noise nats that count as one nat (``evidence.temperature``).
    """
    assert problem.instruments is not None
    probes = probe_blocks(problem, fitted, innovation_noise(problem))
    powers = np.mean(mean_squares(problem, fitted.innovations), axis=0) / innovation_noise(problem) ** 2
    share = np.sqrt(probes[0].explained * powers) * problem.instruments / problem.flights.peaks
    natural = np.hypot(NATURAL, tolerance_of(problem.flights) / problem.flights.peaks)
    return Residual(
        float(np.max((share / natural)[problem.flights.telling])),
        shares_of([probe.block for probe in probes], [probe.gain / heat for probe in probes]),
    )


def shares_of(blocks: Sequence[str], nats: Sequence[float]) -> Mapping[str, float]:
    """Return the probability of each block, given that a disturbance acts in exactly one block."""
    shares = np.exp(np.array(nats) - np.logaddexp.reduce(nats))
    return {block: float(p) for block, p in zip(blocks, shares, strict=True) if p > _HARDLY}


def innovation_noise(problem: EffectProblem) -> FloatArray:
    """Return the noise of the innovations, shape (channels,): 1 where the filter knows the noise."""
    assert problem.instruments is not None
    return np.ones(len(problem.channels)) if problem.knows_the_noise else problem.instruments


def _density(size: float, error: float, freedom: int, population: tuple[float, float]) -> float:
    """Return the log density, nats, of a size by its mean and its standard deviation in ``population``.

    A squared size with an error has Student's distribution: it may stand for all sizes on a grid.
    """
    mean, std = population
    sizes, student = np.log([max(size, _LEAST_MISFIT)]), np.zeros(1)
    if error > 0.0:
        sizes = np.linspace(np.log(_LEAST_MISFIT), np.log(1e3), 400)
        student = -0.5 * (freedom + 1) * np.log1p(((size**2 - np.exp(2.0 * sizes)) / error) ** 2 / freedom)
    density = -0.5 * ((sizes - mean) / std) ** 2 - np.log(std)
    return float(np.logaddexp.reduce(student + density) - np.logaddexp.reduce(student))
