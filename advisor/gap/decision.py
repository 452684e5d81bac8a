"""One decision of the diagnosis: the comparison of a statistic with its limit. Several modules share the
limits of this module."""

from dataclasses import dataclass

LEAST_GAIN = 6.0
"""Least gain in log likelihood, nats, by which one explanation is preferred: odds of 400 to 1. Two
explanations that differ by less than this gain are equivalent."""
CERTAIN = 30.0
"""Gain in log likelihood, nats, above which something like an effect, or moving air, is certainly
present. On 40 flights of two generators no gain of moving air lies between 21 and 64."""
SIGMAS = 5.0
"""Least number of standard deviations of a difference that a check without a model reports. Checked are air
speed, weight, offset of α, wind, and speeds of manoeuvres. Errors of these checks are not Gaussian, so three
standard deviations are too few.
"""


def differs_from_zero(value: float, std: float) -> bool:
    """Return whether a parameter with a Gaussian error gains at least ``LEAST_GAIN`` over zero."""
    return 0.5 * value**2 > LEAST_GAIN * std**2


@dataclass(frozen=True, slots=True)
class Decision:
    """One yes-or-no question, answered yes if a statistic is at least its limit."""

    about: str
    """Effect, block or verdict that the question is about."""
    name: str
    """The question in one or two words."""
    statistic: float
    limit: float
    unit: str
    """Unit of the statistic and of the limit."""

    @property
    def margin(self) -> float:
        """Statistic minus limit, positive where the limit is exceeded."""
        return self.statistic - self.limit

    @property
    def holds(self) -> bool:
        """Whether the statistic is at least the limit."""
        return self.statistic >= self.limit
