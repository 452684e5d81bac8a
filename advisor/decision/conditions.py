"""Conditions of the next input (trim, instruments, limits), and the number of manoeuvres that remain."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.decision.history import CandidateManeuver, estimates_of, usable_ones
from advisor.decision.information import CriterionCourse, Knowledge
from advisor.decision.paper_rules import SCATTER_FACTOR
from advisor.decision.pooling import DERIVATIVES, Posterior, covariance_of, information_of
from advisor.decision.prediction import UNMEASURED, Instruments, response_to, trim_of
from advisor.decision.verdict import Remaining
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.quantities import NORMAL_95

FULL_TRAVEL_RAD = float(np.radians(25.0))
"""Travel of a control on either side of trim without a calibration, rad."""
BOLDER = 1.5
"""Largest ratio of the next input, and of its response, to the largest input so far. The amplitude is built
up in steps."""
LINEAR_RAD = float(np.radians(5.0))
"""Largest deviation of α from trim for which the model is taken as linear, rad, without a stated limit."""
ALPHA_MARGIN = 0.9
"""Share of an angle-of-attack limit that the next input may use. The margin allows for errors of the
model."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """Trim, instruments and limits of the next input, after the last manoeuvre."""

    theta: FloatArray
    trim_rad: float
    lead_s: float
    free_s: float
    instruments: Instruments
    flown: Signal
    """Elevator of the last manoeuvre."""
    largest_rad: float
    """Largest amplitude of the elevator that the limits allow, rad."""
    alpha_rad: float
    """Largest deviation of α that the limits allow, rad."""
    travel_rad: float
    """Elevator travel from trim to the nearer stop, rad, which is 100 % stick."""
    nose_up_first: bool
    """Whether the last manoeuvre's first step was nose up."""
    last_covariance: FloatArray
    """Shape (8, 8): covariance of the last manoeuvre's estimate for given instruments."""


def find_conditions(
    history: Sequence[CandidateManeuver], aircraft: Aircraft, course: CriterionCourse
) -> Conditions | None:
    """Return trim, instruments and limits from the usable manoeuvres; None without one."""
    flown = [(m, e, m.maneuver) for m in history if (e := m.usable) and m.maneuver is not None]
    if not flown:
        return None
    _, estimate, last = flown[-1]
    fits = estimate.fits[0]
    span, elevator = last.span, last.channels["elevator"]
    theta = course.knowledge(usable_ones(history)).posterior.theta
    trim = trim_of(last)
    travel = travel_of(aircraft.elevator.ends_deg, trim)
    largest_seen = max(_excursion(m, e) for m, e, _ in flown)
    alpha = max(largest_seen, min(BOLDER * largest_seen, LINEAR_RAD))
    if aircraft.limits.alpha_deg is not None:
        # Where no angle of attack is measured, the limit can be kept about trim only.
        start = float(np.median(fits["alpha"].fitted[:5])) if "alpha" in fits else 0.0
        alpha = max(ALPHA_MARGIN * (np.radians(aircraft.limits.alpha_deg) - start), 0.25 * largest_seen)
    largest = max(float(np.max(np.abs(_about_trim(m)))) for *_, m in flown)
    return Conditions(
        theta=theta,
        trim_rad=trim,
        lead_s=max(span.start_s - span.record_from_s, 0.5),
        free_s=max(span.end_s - span.last_step_s, 1.0),
        instruments=_instruments(
            estimate, Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0)
        ),
        flown=Signal(elevator.t - elevator.t[0], elevator.y),
        largest_rad=min(BOLDER * largest, ALPHA_MARGIN * travel),
        alpha_rad=float(alpha),
        travel_rad=travel,
        nose_up_first=_nose_up_first(last),
        last_covariance=estimate.own_covariance,
    )


def _about_trim(maneuver: Maneuver) -> FloatArray:
    return maneuver.channels["elevator"].y - trim_of(maneuver)


def _nose_up_first(maneuver: Maneuver) -> bool:
    """Return whether the first large movement of the elevator is trailing edge up."""
    moved = _about_trim(maneuver)
    return bool(moved[np.argmax(np.abs(moved) >= 0.5 * np.max(np.abs(moved)))] < 0.0)


def _instruments(estimate: Estimate, servo: Servo) -> Instruments:
    fits = estimate.fits[0]
    q = fits["q"]
    if "alpha" in fits or "a_z" not in fits:
        alpha = fits.get("alpha", q)
        return Instruments((_step(alpha.t), _step(q.t)), (alpha.noise, q.noise), servo)
    force = fits["a_z"]
    noise = force.noise / (estimate.airspeed_m_s or 1.0)
    return Instruments((_step(q.t), _step(q.t)), (UNMEASURED, q.noise), servo, (_step(force.t), noise))


def _excursion(flown: CandidateManeuver, estimate: Estimate) -> float:
    """Return the largest change of α from its initial value, rad, from the fit, or from a prediction without
    a measured α.
    """
    if "alpha" not in estimate.fits[0]:
        response = response_to(flown, estimate.theta[list(DERIVATIVES)], None)
        return LINEAR_RAD if response is None else float(response.peak[0])
    fitted = estimate.fits[0]["alpha"].fitted
    return float(np.max(np.abs(fitted - fitted[0])))


def _step(t: FloatArray) -> float:
    return float(np.median(np.diff(t)))


def travel_of(ends_deg: tuple[float, float] | None, trim_rad: float = 0.0) -> float:
    """Return the travel of a control from trim to the nearer stop, rad: 100 % stick.

    Parameters
    ----------
    ends_deg
        Stops of the calibration, deg; None without a calibration.
    """
    low, high = np.radians(ends_deg) if ends_deg else (-FULL_TRAVEL_RAD, FULL_TRAVEL_RAD)
    return float(max(min(high - trim_rad, trim_rad - low), 0.1 * FULL_TRAVEL_RAD))


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
