"""Do the manoeuvres agree as well as their errors say: which one is the odd one, and how much wider to be."""

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
"""Chance level below which scatter between manoeuvres widens the intervals."""
ODD_BELOW = 1e-3
"""Chance level below which an odd manoeuvre is looked for."""
ODD_IMPROVEMENT = 3.0
"""Leaving out an odd manoeuvre must lower χ² per degree of freedom by this factor."""
FEWEST = 4
"""With fewer manoeuvres nobody knows which one is odd."""


@dataclass(frozen=True, slots=True)
class Odd:
    """How far a manoeuvre is from what all the others say."""

    sigma: float
    """Mahalanobis distance of its derivatives."""
    limit: float
    """What chance exceeds once in a thousand."""


def odd_ones(beliefs: Sequence[Belief]) -> Mapping[int, Odd]:
    """Return manoeuvres that contradict all the others, which agree among themselves, by their index.

    A search may end in a wrong minimum, or a gust may look like a response: such an estimate has a
    small stated error and would spoil every mean. At most a third of the manoeuvres is odd; more is
    not oddness but a change, or errors that are stated too small.
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

    The Birge ratio of metrology: χ² of the derivatives about their pooled value over its degrees of
    freedom.
    """
    if len(beliefs) < 2:
        return 1.0
    _, total, dof = pooled(beliefs)
    return 1.0 if dof < 1 or total < float(chdtri(dof, WIDEN_BELOW)) else total / dof


def widened(belief: Belief, factor: float) -> Belief:
    """Return the same value with ``factor`` times its variance."""
    return Belief(belief.theta, factor * belief.covariance)


def consensus(beliefs: Sequence[Belief]) -> tuple[Belief, float, tuple[int, ...]]:
    """Return the pooled belief without the odd manoeuvres, the widening in it, and who was left out."""
    odd = tuple(odd_ones(beliefs))
    agreeing = [belief for i, belief in enumerate(beliefs) if i not in odd]
    factor = excess(agreeing)
    return widened(pool(agreeing), factor), factor, odd
