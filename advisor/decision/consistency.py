"""Consistency of manoeuvres: outliers among them, and the factor by which scatter widens the intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.decision.pooling import (
    Posterior,
    Shared,
    disagreement,
    pool,
    pooled,
    pooled_without_each,
)

WIDEN_BELOW = 0.05
"""Probability below which scatter between manoeuvres widens the intervals."""
OUTLIER_BELOW = 1e-3
"""Probability below which an outlier is looked for."""
OUTLIER_IMPROVEMENT = 3.0
"""Least factor by which leaving out an outlier must lower χ² per degree of freedom."""
FEWEST = 4
"""Fewest manoeuvres among which an outlier can be identified."""


@dataclass(frozen=True, slots=True)
class Outlier:
    """Distance of an outlying manoeuvre from all others."""

    sigma: float
    """Mahalanobis distance of the manoeuvre's derivatives."""
    limit: float
    """Distance that chance exceeds once in a thousand cases."""


def outliers(posteriors: Sequence[Posterior]) -> Mapping[int, Outlier]:
    """Return manoeuvres that contradict all the others, which agree with each other, by their index.

    A search may end in a wrong minimum, or a gust may look like a response. Such an estimate has a small
    stated error and would spoil every mean. At most a third of the manoeuvres are outliers. More
    contradictions mean a change of the aircraft, or stated errors that are too small.
    """
    inside = list(range(len(posteriors)))
    found: list[int] = []
    while len(inside) >= FEWEST and len(found) + 1 <= (len(posteriors) - 1) // 3:
        together = [posteriors[i] for i in inside]
        _, total, dof = pooled(together)
        if dof < 1 or total < float(chdtri(dof, OUTLIER_BELOW)):
            break
        remaining = dict(zip(inside, pooled_without_each(together), strict=True))
        candidate = min(remaining, key=lambda i: remaining[i].inconsistency)
        _, rest, rest_dof = remaining[candidate]
        if rest_dof < 1 or rest / rest_dof * OUTLIER_IMPROVEMENT > total / dof:
            break
        inside.remove(candidate)
        found.append(candidate)
    if not found:
        return {}
    others = pooled([posteriors[i] for i in inside]).shared
    return {i: _distance(posteriors[i], others) for i in sorted(found)}


def _distance(outlier: Posterior, others: Shared) -> Outlier:
    distance, dof = disagreement(others, outlier.shared)
    return Outlier(float(np.sqrt(distance)), float(np.sqrt(chdtri(max(dof, 1), OUTLIER_BELOW))))


def excess(posteriors: Sequence[Posterior]) -> float:
    """Return the variance ratio of the scatter between manoeuvres to their stated errors, 1 unless
    significant.

    The Birge ratio of metrology: χ² of the derivatives about their pooled value, divided by its degrees of
    freedom.
    """
    if len(posteriors) < 2:
        return 1.0
    _, total, dof = pooled(posteriors)
    return 1.0 if dof < 1 or total < float(chdtri(dof, WIDEN_BELOW)) else total / dof


def widened(posterior: Posterior, factor: float) -> Posterior:
    """Return the estimate with ``factor`` times its own variance. Scatter tells nothing of a common error."""
    return Posterior(posterior.theta, factor * posterior.covariance, posterior.common)


def consensus(posteriors: Sequence[Posterior]) -> tuple[Posterior, float, tuple[int, ...]]:
    """Return the pooled estimate without outliers, the factor that widened its variance, and the indices of
    the outliers."""
    left_out = tuple(outliers(posteriors))
    agreeing = [posterior for i, posterior in enumerate(posteriors) if i not in left_out]
    factor = excess(agreeing)
    return widened(pool(agreeing), factor), factor, left_out
