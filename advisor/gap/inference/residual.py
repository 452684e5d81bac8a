"""The residual of a model: the disturbance of free course that explains most of it, block by block."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import probe_blocks
from advisor.gap.records.floor import tolerance_of

_HARDLY = 1e-6
"""Numerical: share below which a block counts as excluded."""
_NATURAL = 0.004
"""Prior: motion that a right simulator leaves unexplained, as a share of a channel's peak."""


@dataclass(frozen=True)
class Residual:
    """Motion that a model does not explain and that is no noise."""

    size: float
    """Motion beyond the noise that the likeliest disturbance explains, over what every simulator leaves. The
    channel counts in which that ratio is largest."""
    blocks: Mapping[str, float]
    """Probability of each block, given that something without a name acts in one."""


def residual_of(problem: EffectProblem, fitted: EffectFit, heat: float) -> Residual:
    """Return the disturbance that explains the residual of a fit.

    Parameters
    ----------
    heat
        Nats of white noise that count as one (``evidence.temperature``).
    """
    assert problem.instruments is not None
    probes = probe_blocks(problem, fitted, innovation_noise(problem))
    powers = np.mean(mean_squares(problem, fitted.innovations), axis=0) / innovation_noise(problem) ** 2
    share = np.sqrt(probes[0].explained * powers) * problem.instruments / problem.flights.peaks
    natural = np.hypot(_NATURAL, tolerance_of(problem.flights) / problem.flights.peaks)
    gains = np.array([probe.gain for probe in probes]) / heat
    parts = np.exp(gains - np.max(gains))
    parts /= np.sum(parts)
    return Residual(
        float(np.max((share / natural)[problem.flights.telling])),
        {probe.block: float(p) for probe, p in zip(probes, parts, strict=True) if p > _HARDLY},
    )


def innovation_noise(problem: EffectProblem) -> FloatArray:
    """Return the noise of the innovations, shape (channels,): 1 where the filter knows the noise."""
    assert problem.instruments is not None
    return np.ones(len(problem.channels)) if problem.knows_the_noise else problem.instruments
