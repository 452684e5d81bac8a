"""How many more manoeuvres: what each rule needs when the next ones teach as expected."""

from collections.abc import Sequence

import numpy as np
from scipy.special import nbdtr

from advisor.aircraft import CampaignPlan
from advisor.decision.history import Flown
from advisor.decision.information import Knowledge
from advisor.decision.inverses import covariance_of, information_of
from advisor.decision.pooling import DERIVATIVES, Belief
from advisor.decision.prediction import Z95
from advisor.decision.scatter import SCATTER_FACTOR
from advisor.decision.verdict import Remaining
from advisor.flight.messages import FloatArray

MOST = 50
"""Beyond this many there is no end in sight."""
_DRAWS = 400


def by_information(known: Knowledge, next_covariance: FloatArray, usable_share: float) -> Remaining:
    """Return more manoeuvres until all that must be known is within its tolerance and the newest is
    predicted.

    Parameters
    ----------
    known
        What is known now.
    next_covariance
        (8, 8) of the errors to expect from each further manoeuvre.
    usable_share
        Share of manoeuvres that turn out usable.
    """
    good = 1 if np.isnan(known.surprise) or not known.predicted else 0
    while good <= MOST and share_after(known, next_covariance, good) >= 1.0:
        good += 1
    if good > MOST:
        return Remaining(None, None)
    return Remaining(good, _flights_for(good, usable_share, 0.9))


def share_after(known: Knowledge, next_covariance: FloatArray, more: int) -> float:
    """Return the largest uncertainty over its tolerance after ``more`` manoeuvres with errors as in
    ``next_covariance``.

    Trims and the constants that hold them are each manoeuvre's own: only their variances add up.
    """
    inside = np.ix_(DERIVATIVES, DERIVATIVES)
    information = known.belief.information + more * information_of(next_covariance[inside])
    covariance = covariance_of(information)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = 1.0 / (1.0 / known.belief.std**2 + more / np.diag(next_covariance))
        variance[list(DERIVATIVES)] = np.diag(covariance)
        half = np.nan_to_num(Z95 * np.sqrt(variance) / known.tolerance, nan=np.inf)
    return max(known.shares_with(known.prediction.percent(covariance), half).values(), default=np.inf)


def by_scatter(
    window: FloatArray, belief: Belief, next_std: FloatArray, plan: CampaignPlan, accepted_share: float
) -> Remaining:
    """Return more manoeuvres until the scatter of the last n accepted ones is below the limit, by simulation.

    Parameters
    ----------
    window
        (k, 8) the last accepted estimates, at most n - 1 of which stay in the next window.
    belief
        The values about which the next estimates scatter, with their errors.
    next_std
        (8,) that scatter.
    accepted_share
        Share of manoeuvres that the rule accepts.
    """
    rng = np.random.default_rng(0)
    centre = np.where(np.isfinite(belief.theta), belief.theta, 0.0)
    spread = np.where(np.isfinite(next_std), next_std, np.abs(centre))
    kept = window[len(window) - min(len(window), plan.window - 1) :]
    future = centre + spread * rng.standard_normal((_DRAWS, MOST, len(centre)))
    series = np.concatenate([np.broadcast_to(kept, (_DRAWS, *kept.shape)), future], axis=1)
    windows = np.lib.stride_tricks.sliding_window_view(series, plan.window, axis=1)
    mean, scatter = np.abs(windows.mean(axis=-1)), SCATTER_FACTOR * windows.std(axis=-1, ddof=1)
    relative = np.divide(scatter, mean, out=np.full_like(mean, np.inf), where=mean > 0.0)
    agree = 100.0 * np.linalg.norm(relative, axis=-1) < plan.limit_percent
    # The windows before the first full one end in manoeuvres that cannot stop the test yet.
    accepted = np.argmax(agree, axis=1) + plan.window - len(kept)
    flights = np.cumsum(rng.geometric(accepted_share, (_DRAWS, MOST)), axis=1)
    needed = np.where(agree.any(axis=1), flights[np.arange(_DRAWS), accepted - 1].astype(float), np.inf)
    median, p90 = np.quantile(needed, [0.5, 0.9], method="higher")
    return Remaining(*(int(n) if n <= MOST else None for n in (median, p90)))


def usable_share(history: Sequence[Flown]) -> float:
    """Return the share of manoeuvres that were usable, with the experience of nine good out of ten before the
    first."""
    good = sum(flown.usable is not None for flown in history)
    return (good + 9.0) / (len(history) + 10.0)


def _flights_for(good: int, share: float, confidence: float) -> int:
    """Return flights within which ``good`` usable ones come about with this confidence (negative
    binomial)."""
    spoilt = 0
    # To rounding: half of all chances may be reached exactly.
    while good and nbdtr(spoilt, good, share) < confidence - 1e-12:
        spoilt += 1
    return good + spoilt
