"""Consistency of manoeuvres: outliers among them, and the factor by which scatter widens the intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.decision.pooling import (
    Belief,
    Shared,
    disagreement,
    pool,
    pooled,
    pooled_without_each,
)

WIDEN_BELOW = 0.05
"""Probability below which scatter between manoeuvres widens the intervals."""
ODD_BELOW = 1e-3
"""Probability below which an outlier is looked for."""
ODD_IMPROVEMENT = 3.0
"""Least factor by which leaving out an outlier must lower χ² per degree of freedom."""
FEWEST = 4
"""Fewest manoeuvres among which an outlier can be identified."""


@dataclass(frozen=True, slots=True)
class Odd:
    """Distance of an outlying manoeuvre from all others."""

    sigma: float
    """Mahalanobis distance of the manoeuvre's derivatives."""
    limit: float
    """Distance that chance exceeds once in a thousand cases."""


def odd_ones(beliefs: Sequence[Belief]) -> Mapping[int, Odd]:
    """Return manoeuvres that contradict all the others, which agree with each other, by their index.

    A search may end in a wrong minimum, or a gust may look like a response. Such an estimate has a small
    stated error and would spoil every mean. At most a third of the manoeuvres are outliers. More
    contradictions mean a change of the aircraft, or stated errors that are too small.
    """
    inside = list(range(len(beliefs)))
    odd: list[int] = []
    while len(inside) >= FEWEST and len(odd) + 1 <= (len(beliefs) - 1) // 3:
        together = [beliefs[i] for i in inside]
        _, total, dof = pooled(together)
        if dof < 1 or total < float(chdtri(dof, ODD_BELOW)):
            break
        remaining = dict(zip(inside, pooled_without_each(together), strict=True))
        candidate = min(remaining, key=lambda i: remaining[i].inconsistency)
        _, rest, rest_dof = remaining[candidate]
        if rest_dof < 1 or rest / rest_dof * ODD_IMPROVEMENT > total / dof:
            break
        inside.remove(candidate)
        odd.append(candidate)
    if not odd:
        return {}
    others = pooled([beliefs[i] for i in inside]).shared
    return {i: _distance(beliefs[i], others) for i in sorted(odd)}


def _distance(odd: Belief, others: Shared) -> Odd:
    distance, dof = disagreement(others, odd.shared)
    return Odd(float(np.sqrt(distance)), float(np.sqrt(chdtri(max(dof, 1), ODD_BELOW))))


def excess(beliefs: Sequence[Belief]) -> float:
    """Return the variance ratio of the scatter between manoeuvres to their stated errors, 1 unless
    significant.

    The Birge ratio of metrology: χ² of the derivatives about their pooled value, divided by its degrees of
    freedom.
    """
    if len(beliefs) < 2:
        return 1.0
    _, total, dof = pooled(beliefs)
    return 1.0 if dof < 1 or total < float(chdtri(dof, WIDEN_BELOW)) else total / dof


def widened(belief: Belief, factor: float) -> Belief:
    """Return the estimate with ``factor`` times its variance."""
    return Belief(belief.theta, factor * belief.covariance)


def consensus(beliefs: Sequence[Belief]) -> tuple[Belief, float, tuple[int, ...]]:
    """Return the pooled estimate without outliers, the factor that widened its variance, and the indices of
    the outliers."""
    odd = tuple(odd_ones(beliefs))
    agreeing = [belief for i, belief in enumerate(beliefs) if i not in odd]
    factor = excess(agreeing)
    return widened(pool(agreeing), factor), factor, odd
