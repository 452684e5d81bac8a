"""Expected number of further manoeuvres for each rule, from the expected information."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.course import CriterionCourse
from advisor.decision.history import CandidateManeuver, estimates_of, usable_ones
from advisor.decision.information import Knowledge
from advisor.decision.inverses import covariance_of, information_of
from advisor.decision.paper_rules import SCATTER_FACTOR
from advisor.decision.pooling import DERIVATIVES, Posterior
from advisor.decision.verdict import Remaining
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.quantiles import NORMAL_95


@dataclass(frozen=True, slots=True)
class Share:
    """Share of successes among trials, with a prior of nine successes in ten."""

    hits: int
    misses: int

    @property
    def mean(self) -> float:
        """Mean of the share's posterior."""
        return (self.hits + 9.0) / (self.hits + self.misses + 10.0)

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Return shares drawn from the posterior (beta distribution)."""
        return rng.beta(self.hits + 9.0, self.misses + 1.0, _DRAWS)


@dataclass(frozen=True, slots=True)
class Odds:
    """Shares of usable and of predicted manoeuvres in a campaign."""

    usable: Share
    predicted: Share
    """Share of usable manoeuvres that the earlier manoeuvres predicted."""


MOST = 50
"""Largest number of further manoeuvres that is predicted. A longer forecast says that no
end of the test is in sight."""
_DRAWS = 400


def by_information(knowledge: Knowledge, next_covariance: FloatArray, odds: Odds) -> Remaining:
    """Return the simulated number of further manoeuvres until every tolerance is met and the newest manoeuvre
    is predicted.

    Parameters
    ----------
    next_covariance
        Shape (8, 8): covariance of the expected errors of each further manoeuvre.
    """
    good = 1 if np.isnan(knowledge.surprise) or not knowledge.predicted else 0
    while good <= MOST and share_after(knowledge, next_covariance, good) >= 1.0:
        good += 1
    if good > MOST:
        return Remaining(None, None)
    rng = np.random.default_rng(0)
    usable, predicted = odds.usable.draw(rng), odds.predicted.draw(rng)
    # The test stops with a manoeuvre that was predicted. Each one that was not costs another.
    needed = np.maximum(good, 1) - 1 + rng.geometric(predicted)
    return _told(needed + rng.negative_binomial(needed, usable))


def until_usable(needed: FloatArray, usable: Share) -> Remaining:
    """Return the number of further manoeuvres until enough of them are usable.

    Parameters
    ----------
    needed
        Shape (draws,): number of usable manoeuvres in each draw of ``variance_scale``, at least one.
    """
    rng = np.random.default_rng(0)
    within = np.minimum(needed, MOST + 1.0)
    return _told(within + rng.negative_binomial(within, usable.draw(rng)))


def variance_scale(freedom: int) -> FloatArray:
    """Return draws of the true variance over the stated one, shape (draws,), from a scaled inverse χ².

    A few manoeuvres determine the scatter and the model's error only roughly, so the stated variance is
    itself an estimate.

    Parameters
    ----------
    freedom
        Number of independent comparisons behind the stated variance, at least one.
    """
    rng = np.random.default_rng(1)
    return np.asarray(freedom / rng.chisquare(freedom, _DRAWS))


def _told(flights: FloatArray | IntArray) -> Remaining:
    """Return the forecast from simulated numbers of further manoeuvres, shape (draws,)."""
    median, p90 = np.quantile(flights, [0.5, 0.9], method="higher")
    within = [int(n) if n <= MOST else None for n in (median, p90)]
    return Remaining(within[0], within[1])


def share_after(knowledge: Knowledge, next_covariance: FloatArray, more: int) -> float:
    """Return the largest uncertainty over its tolerance after ``more`` manoeuvres of ``next_covariance``.

    Trims and constants belong to each manoeuvre, so only their variances add up. Further manoeuvres also
    determine the instruments better.
    """
    inside = np.ix_(DERIVATIVES, DERIVATIVES)
    information = knowledge.posterior.information + more * information_of(next_covariance[inside])
    covariance = covariance_of(information)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.diag(knowledge.posterior.covariance)
        variance = 1.0 / (1.0 / own + more / np.diag(next_covariance))
        variance[list(DERIVATIVES)] = np.diag(covariance)
        variance += knowledge.common_after(more)
        half = np.nan_to_num(NORMAL_95 * np.sqrt(variance) / knowledge.tolerance, nan=np.inf)
    return max(knowledge.shares_with(knowledge.prediction.percent(covariance), half).values(), default=np.inf)


def by_scatter(
    window: FloatArray, posterior: Posterior, next_std: FloatArray, plan: CampaignPlan, accepted_share: float
) -> Remaining:
    """Return the simulated number of further manoeuvres until the last n accepted ones scatter little enough.

    Parameters
    ----------
    window
        Shape (k, 8): estimates of the last accepted manoeuvres. At most n - 1 of these estimates remain in
        the next window.
    next_std
        Shape (8,): standard deviations of that scatter.
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
    return _told(np.where(agree.any(axis=1), flights[np.arange(_DRAWS), accepted - 1].astype(float), np.inf))


def odds_of(history: Sequence[CandidateManeuver], course: CriterionCourse) -> Odds:
    """Return the numbers of usable and of predicted manoeuvres in a campaign."""
    usable = usable_ones(history)
    predicted = [course.standing(usable[:k]).predicted for k in range(2, len(usable) + 1)]
    hits = sum(predicted)
    return Odds(Share(len(usable), len(history) - len(usable)), Share(hits, len(predicted) - hits))


def errors_as_flown(usable: Sequence[CandidateManeuver], widening: float) -> FloatArray:
    """Return the covariance of a manoeuvre with the mean information of the flown ones, shape (8, 8).

    Parameters
    ----------
    usable
        Usable manoeuvres so far; at least one.
    widening
        Ratio of the manoeuvres' scatter to their stated variances.
    """
    information = np.mean([information_of(e.own_covariance) for e in estimates_of(usable)], axis=0)
    return np.asarray(widening * covariance_of(information))
