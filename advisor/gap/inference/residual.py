"""The residual of a model: the disturbance of free course that explains most of it, block by block."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem, row_weights
from advisor.gap.noise.probes import probe_blocks
from advisor.gap.uncatalogued.unexplained import innovation_noise

_HARDLY = 1e-6
"""Numerical: share below which a block counts as excluded."""


@dataclass(frozen=True)
class Residual:
    """What a model leaves that is no noise."""

    size: float
    """Root mean square of the likeliest disturbance's response, as a share of the peaks."""
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
    noise = innovation_noise(problem)
    probes = probe_blocks(problem, fitted, noise)
    power = np.mean(
        np.concatenate(
            [(left * row_weights(problem, i, 1.0 / noise)) ** 2 for i, left in enumerate(fitted.innovations)]
        )
    )
    telling = (problem.instruments / problem.flights.peaks)[problem.flights.telling]
    size = float(np.sqrt(max(probe.explained for probe in probes) * power) * np.max(telling))
    gains = np.array([probe.gain for probe in probes]) / heat
    parts = np.exp(gains - np.max(gains))
    parts /= np.sum(parts)
    blocks = {probe.block: float(p) for probe, p in zip(probes, parts, strict=True) if p > _HARDLY}
    return Residual(size, blocks)
