"""Consistency of manoeuvres: outliers, and the factor by which scatter widens the intervals.

The interval of a single manoeuvre does not include the model's error, which only several manoeuvres show. The
scatter of the other manoeuvres is therefore the scale of every distance. The ratio of a distance to an
estimated scale follows Fisher's F distribution.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri, fdtri

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.pooling import (
    Pooled,
    Posterior,
    derivatives_of,
    disagreement,
    pool,
    pooled,
    pooled_without_each,
)
from advisor.decision.tolerance import SHARE
from advisor.words.quantiles import NORMAL_95

WIDEN_BELOW = 0.05
"""Probability of the scatter between manoeuvres below which the intervals are widened."""
OUTLIER_BELOW = 1e-3
"""Probability of the scatter between manoeuvres below which an outlier is sought."""
OUTLIER_IMPROVEMENT = 3.0
"""Least factor by which leaving out an outlier must lower χ² per degree of freedom."""
FEWEST = 4
"""Least number of manoeuvres among which an outlier can be identified."""
USUAL = CampaignPlan()
"""Plan of a crew that states no tolerance."""


@dataclass(frozen=True, slots=True)
class AlphaApart:
    """Angle of attack of a manoeuvre whose middle lies outside the range of the other manoeuvres."""

    middle_rad: float
    """Middle of the manoeuvre's angle of attack range, to which its derivatives apply, rad."""
    others_rad: tuple[float, float]
    """Lowest and highest angle of attack of the other manoeuvres, rad."""


@dataclass(frozen=True, slots=True)
class Outlier:
    """Distance of an outlying manoeuvre from all others."""

    sigma: float
    """Mahalanobis distance of the manoeuvre's derivatives from those of the other manoeuvres, in units of
    their scatter."""
    limit: float
    """Distance that chance exceeds once in a thousand cases."""
    alpha: AlphaApart | None = None
    """Angle of attack that distinguishes the manoeuvre from the others. None if the angle of attack does not
    distinguish it."""


def outliers(posteriors: Sequence[Posterior], plan: CampaignPlan = USUAL) -> Mapping[int, Outlier]:
    """Return the manoeuvres that contradict all others, while the others agree, by index.

    The aircraft may differ at the manoeuvre's angle of attack (`beyond_in_alpha`). The search may also have
    ended in a wrong minimum, or a gust may look like a response. Such an estimate has a small stated error
    and would distort every mean. At most a third of the remaining manoeuvres are such outliers. More
    contradictions mean a change of the aircraft, or stated errors that are too small.

    Parameters
    ----------
    plan
        Derivatives that the crew judges, with the differences that the crew tolerates. A manoeuvre whose
        judged derivatives differ less is no outlier, however small the stated errors are.
    """
    beyond = beyond_in_alpha(posteriors, plan)
    within = [i for i in range(len(posteriors)) if i not in beyond]
    odd = _odd([posteriors[i] for i in within], plan)
    return dict(sorted({**beyond, **{within[k]: outlier for k, outlier in odd.items()}}.items()))


def beyond_in_alpha(posteriors: Sequence[Posterior], plan: CampaignPlan = USUAL) -> dict[int, Outlier]:
    """Return manoeuvres with an angle of attack outside the others' range and contradicting derivatives.

    In buffet and in a stall the aircraft has different derivatives. Neither a large angle of attack alone nor
    a contradiction alone shows buffet or a stall. An aircraft may be linear outside the others' range, and a
    contradiction may have another cause. A minority at one end of the range is compared with all others,
    whose scatter widens the errors of both.
    """
    measured = [i for i, posterior in enumerate(posteriors) if np.all(np.isfinite(posterior.alpha_rad))]
    rising = sorted(measured, key=lambda i: _middle(posteriors[i]))
    outliers: dict[int, Outlier] = {}
    for order in (rising, rising[::-1]):
        for k in range(1, (len(order) + 1) // 2):
            rest = [posteriors[i] for i in order[:-k]]
            lowest = min(posterior.alpha_rad[0] for posterior in rest)
            highest = max(posterior.alpha_rad[1] for posterior in rest)
            nearest = _middle(posteriors[order[-k]])
            if lowest <= nearest <= highest:
                continue
            others = pooled(rest)
            for i in order[-k:]:
                apart = AlphaApart(_middle(posteriors[i]), (lowest, highest))
                if (outlier := _apart(posteriors[i], others, plan)) is not None:
                    outliers[i] = replace(outlier, alpha=apart)
    return outliers


def _middle(posterior: Posterior) -> float:
    return 0.5 * sum(posterior.alpha_rad)


def _odd(posteriors: Sequence[Posterior], plan: CampaignPlan) -> dict[int, Outlier]:
    """Return the manoeuvres without which the others agree, by index."""
    inside = list(range(len(posteriors)))
    outside: list[int] = []
    while len(inside) >= FEWEST and len(outside) + 1 <= (len(posteriors) - 1) // 3:
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
        outside.append(candidate)
    if not outside:
        return {}
    others = pooled([posteriors[i] for i in inside])
    apart = {i: _apart(posteriors[i], others, plan) for i in sorted(outside)}
    return {i: outlier for i, outlier in apart.items() if outlier is not None}


def _apart(candidate: Posterior, others: Pooled, plan: CampaignPlan) -> Outlier | None:
    """Return the distance of a manoeuvre that differs significantly and in size; None for any other
    manoeuvre.
    """
    shared, scatter, freedom = others
    distance, dof = disagreement(shared, candidate.shared)
    if dof < 1 or freedom < 1:
        return None
    scale = max(1.0, scatter / freedom)
    outlier = Outlier(
        float(np.sqrt(distance / scale)), float(np.sqrt(dof * fdtri(dof, freedom, 1.0 - OUTLIER_BELOW)))
    )
    large = _differs_in_size(candidate, others, scale, plan)
    return outlier if large and outlier.sigma > outlier.limit else None


def _differs_in_size(candidate: Posterior, others: Pooled, scale: float, plan: CampaignPlan) -> bool:
    """Return whether a judged derivative differs by more than its tolerance and by more than its error."""
    shared, own, names = others.shared, candidate.shared, derivatives_of(candidate.names)
    for name in set(plan.parameters) & set(names):
        k = names.index(name)
        difference = abs(float(own.theta[k] - shared.theta[k]))
        error = NORMAL_95 * np.sqrt(scale * (own.covariance[k, k] + shared.covariance[k, k]))
        usual = 0.01 * plan.tolerance_percent * SHARE * abs(float(shared.theta[k]))
        if difference > max(error, plan.tolerance.get(name, usual)):
            return True
    return False


def excess(posteriors: Sequence[Posterior]) -> float:
    """Return the ratio of the scatter between manoeuvres to the stated variances; 1 unless significant.

    The ratio is metrology's Birge ratio: χ² of the derivatives about their pooled value, over its degrees of
    freedom.
    """
    if len(posteriors) < 2:
        return 1.0
    _, total, dof = pooled(posteriors)
    return 1.0 if dof < 1 or total < float(chdtri(dof, WIDEN_BELOW)) else total / dof


def widened(posterior: Posterior, factor: float) -> Posterior:
    """Return the estimate with its own variance multiplied by ``factor``. Scatter between manoeuvres does not
    show a common error."""
    return replace(posterior, covariance=factor * posterior.covariance)


def consensus(
    posteriors: Sequence[Posterior], plan: CampaignPlan = USUAL
) -> tuple[Posterior, float, tuple[int, ...]]:
    """Return the pooled estimate without outliers, its variance factor, and the indices of the outliers."""
    left_out = tuple(outliers(posteriors, plan))
    agreeing = [posterior for i, posterior in enumerate(posteriors) if i not in left_out]
    factor = excess(agreeing)
    return widened(pool(agreeing), factor), factor, left_out
