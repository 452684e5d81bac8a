"""Expected number of further manoeuvres, for each rule, if the next ones give the expected information."""

from collections.abc import Sequence

import numpy as np
from scipy.special import nbdtr

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import Knowledge
from advisor.decision.inverses import covariance_of, information_of
from advisor.decision.pooling import DERIVATIVES, Posterior
from advisor.decision.scatter import SCATTER_FACTOR
from advisor.decision.verdict import Remaining
from advisor.flight.signals.messages import FloatArray
from advisor.words.quantiles import NORMAL_95

MOST = 50
"""Largest number that is predicted. Beyond it there is no end in sight."""
_DRAWS = 400


def by_information(known: Knowledge, next_covariance: FloatArray, usable_share: float) -> Remaining:
    """Return the number of further manoeuvres until every tolerance is met and the newest manoeuvre is
    predicted.

    Parameters
    ----------
    known
        Present knowledge.
    next_covariance
        (8, 8) covariance of the errors expected from each further manoeuvre.
    usable_share
        Share of manoeuvres that are usable.
    """
    good = 1 if np.isnan(known.surprise) or not known.predicted else 0
    while good <= MOST and share_after(known, next_covariance, good) >= 1.0:
        good += 1
    if good > MOST:
        return Remaining(None, None)
    return Remaining(good, _flights_for(good, usable_share, 0.9))


def share_after(known: Knowledge, next_covariance: FloatArray, more: int) -> float:
    """Return the largest uncertainty over its tolerance after ``more`` manoeuvres with ``next_covariance``
    each.

    Trims and the constants that hold them belong to each manoeuvre: only their variances add up.
    """
    inside = np.ix_(DERIVATIVES, DERIVATIVES)
    information = known.posterior.information + more * information_of(next_covariance[inside])
    covariance = covariance_of(information)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = 1.0 / (1.0 / known.posterior.std**2 + more / np.diag(next_covariance))
        variance[list(DERIVATIVES)] = np.diag(covariance)
        half = np.nan_to_num(NORMAL_95 * np.sqrt(variance) / known.tolerance, nan=np.inf)
    return max(known.shares_with(known.prediction.percent(covariance), half).values(), default=np.inf)


def by_scatter(
    window: FloatArray, posterior: Posterior, next_std: FloatArray, plan: CampaignPlan, accepted_share: float
) -> Remaining:
    """Return the number of further manoeuvres until the scatter of the last n accepted ones is low enough, by
    simulation.

    Parameters
    ----------
    window
        (k, 8) last accepted estimates. At most n - 1 of them stay in the next window.
    posterior
        Values about which the next estimates scatter, with their errors.
    next_std
        (8,) standard deviations of that scatter.
    accepted_share
        Share of manoeuvres that the rule accepts.
    """
    rng = np.random.default_rng(0)
    centre = np.where(np.isfinite(posterior.theta), posterior.theta, 0.0)
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


def usable_share(history: Sequence[CandidateManeuver]) -> float:
    """Return the share of usable manoeuvres so far, with a prior of nine good manoeuvres out of ten."""
    good = sum(flown.usable is not None for flown in history)
    return (good + 9.0) / (len(history) + 10.0)


def _flights_for(good: int, share: float, confidence: float) -> int:
    """Return the number of flights that give ``good`` usable ones with this confidence (negative
    binomial)."""
    spoilt = 0
    # To rounding: half of all chances may be reached exactly.
    while good and nbdtr(spoilt, good, share) < confidence - 1e-12:
        spoilt += 1
    return good + spoilt
