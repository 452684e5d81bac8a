"""A measured value with its error, the weighted mean of several values, and hypotheses about an instrument's
scale.

A reading is the true value times a factor: 1 as stated, −1 for a reversed sense, 57.3 for degrees that are
read as radians. Around each factor the scale of an instrument scatters by a known share. All hypotheses have
equal prior probability, and the posterior follows from the likelihoods. One further hypothesis allows any
scale, so that the nearest factor may also be wrong.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import exp, hypot, log, pi, sqrt

import numpy as np

from advisor.flight.instruments.alpha_offset import weighted


@dataclass(frozen=True, slots=True)
class Measured:
    """A measured value and its standard deviation."""

    value: float
    std: float


Evidence = Mapping[str, Measured]
"""Measured value of each quantity, by the quantity's name."""


def pooled(several: Iterable[Evidence]) -> dict[str, Measured]:
    """Return the weighted mean of every quantity over the records that contain it.

    Scatter between records that exceeds their stated errors widens the error.
    """
    together: dict[str, list[Measured]] = {}
    for evidence in several:
        for name, measured in evidence.items():
            if np.isfinite(measured.value) and measured.std > 0.0:
                together.setdefault(name, []).append(measured)
    return {
        name: Measured(*weighted([m.value for m in estimates], [m.std for m in estimates]))
        for name, estimates in together.items()
    }


AS_STATED = "as stated"
ANY = "any other scale"
_DECADES = 4.0
"""Decades of scale, from 0.01 to 100 with either sign, over which "any other scale" is uniform. The ratio of
any two units in use lies within this range."""
EXCLUDED = 0.01
"""Largest posterior probability of an excluded hypothesis: the usual level of 99 %."""
_RESOLVED_SIGMAS = 3.0
"""Least distance of a measured scale from zero, in standard deviations, for a significant scale. A smaller
scale may be noise, which any unit of small readings explains."""


@dataclass(frozen=True, slots=True)
class Weighed:
    """Posterior over the hypotheses on one scale."""

    best: str
    """Name of the likeliest hypothesis."""
    factor: float
    """Factor of the likeliest hypothesis, or the measured scale for ``ANY``."""
    stated_probability: float
    """Posterior probability that the instrument reads as stated (``AS_STATED``)."""
    resolved: bool
    """Whether the reading follows the motion beyond its errors."""

    @property
    def contradicts(self) -> bool:
        """Whether the measured scale excludes the stated one."""
        return self.resolved and self.stated_probability < EXCLUDED


def weigh(measured: Measured, factors: Mapping[str, float], width: float, stated: float = 1.0) -> Weighed:
    """Return the posterior probabilities of the hypotheses about a scale.

    Parameters
    ----------
    factors
        Factor of each hypothesis relative to the stated reading, without ``AS_STATED``.
    width
        Standard deviation of an instrument's scale, as a share.
    stated
        Mean scale of an instrument that reads as stated.
    """
    candidates = {AS_STATED: 1.0, **factors}
    likelihood = {
        name: _normal(
            measured.value - factor * stated, hypot(width * abs(factor * stated), measured.std)
        )
        for name, factor in candidates.items()
    }  # fmt: skip
    size = max(abs(measured.value), measured.std)
    likelihood[ANY] = 1.0 / (2.0 * _DECADES * log(10.0) * size)
    total = sum(likelihood.values())
    best = max(likelihood, key=lambda name: likelihood[name])
    factor = candidates.get(best, measured.value)
    resolved = abs(measured.value) >= _RESOLVED_SIGMAS * measured.std
    return Weighed(best, factor, likelihood[AS_STATED] / total, resolved)


def _normal(distance: float, std: float) -> float:
    return exp(-0.5 * (distance / std) ** 2) / (std * sqrt(2.0 * pi))
