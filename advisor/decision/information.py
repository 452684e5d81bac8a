"""The rule ``information``, and its course: stop when further manoeuvres change nothing relevant.

The paper's criterion asks whether the last estimates scatter little relative to their mean. The scatter ratio
has no scale for a parameter near zero, and ignores all manoeuvres outside its window. The rule
``information`` asks three questions about the model's use. Is the 95 % band of the predicted response within
the tolerance? Did the earlier manoeuvres predict the newest manoeuvre? Is each derivative with a tolerance
from the crew within that tolerance? A parameter without its own tolerance that changes no prediction delays
no stop.

The interval of a single manoeuvre does not include the model's error, which only several manoeuvres show. The
scatter of the other manoeuvres is therefore the scale of every distance. The ratio of a distance to an
estimated scale follows Fisher's F distribution.

The knowledge after k manoeuvres depends on these k manoeuvres only. A decision after one more manoeuvre adds
one entry to the cache. An excluded, included or re-assessed manoeuvre invalidates its own entry in the cache
and all later entries.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import is_

import numpy as np
from scipy.special import chdtri, fdtri

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.history import CandidateManeuver, estimates_of
from advisor.decision.pooling import (
    DERIVATIVES,
    Pooled,
    Posterior,
    Shared,
    common_airspeed,
    derivatives_of,
    disagreement,
    pool,
    pooled,
    pooled_without_each,
    posteriors_at_one_speed,
)
from advisor.decision.prediction import SHARE, Prediction, missed_percent, predict, tolerances
from advisor.oem.known_instruments import FoundInstruments
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95, distinct_texts, symbol

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


SURPRISING = 0.01
"""Probability below which a manoeuvre contradicts its prediction."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """Knowledge of the aircraft after a number of manoeuvres."""

    posterior: Posterior
    """Pooled estimate of all consistent manoeuvres, widened by excess scatter."""
    prediction: Prediction
    """Predicted response to the flown inputs."""
    tolerance_percent: float
    """Tolerance for the half-width of the prediction's 95 % band, % of the response's peak."""
    named: tuple[str, ...]
    """Parameters for which the crew stated a tolerance."""
    tolerance: FloatArray
    """Shape (8,): tolerance for the 95 % half-width of each named parameter."""
    surprise: float
    """Distance of the newest manoeuvre from its prediction, over the 99 % limit. NaN without a prediction."""
    missed_percent: float
    """Largest error of the newest manoeuvre's prediction, % of the response's peak. NaN without a
    prediction."""
    foretold_percent: float
    """Half-width of the 95 % band of the newest manoeuvre's prediction, % of its peak. NaN without a
    prediction."""
    widening: float
    """Factor by which contradictions between manoeuvres have widened the variance of ``posterior``, at least
    1."""
    left_out: tuple[int, ...]
    """Indices of manoeuvres that contradict all others."""
    not_identifiable: Mapping[str, str]
    """Reason why no manoeuvre identifies a parameter, by the parameter's name. Small errors of such a
    parameter are not knowledge."""
    usable: int
    """Number of usable manoeuvres."""
    given: FoundInstruments | None
    """Instruments that the manoeuvres determined together; None if no instrument is unknown."""

    @property
    def predicted(self) -> bool:
        """Whether the earlier manoeuvres predicted the newest manoeuvre.

        A prediction holds if its error is within the tolerance, because so small a model error does not delay
        the stop. It also holds if chance explains the error and the prediction is more precise than the
        tolerance. An imprecise prediction would agree with any response.
        """
        unsure = self.foretold_percent >= self.tolerance_percent
        return self.missed_percent < self.tolerance_percent or (self.surprise < 1.0 and not unsure)

    @property
    def prediction_percent(self) -> Mapping[str, float]:
        """Largest half-width of each output's 95 % band, % of its peak, by the output's name."""
        return self.prediction.percent(self.posterior.shared.covariance)

    @property
    def share(self) -> Mapping[str, float]:
        """Uncertainty of each quantity of the criterion, as a share of its tolerance. The share is infinite
        if unknown.

        The quantities are the outputs, then the named parameters.
        """
        determined = np.isfinite(self.posterior.std) & np.isfinite(self.posterior.theta)
        determined &= [name not in self.not_identifiable for name in PARAMETERS]
        std = np.where(determined, self.posterior.std, 0.0)
        half = np.where(determined, NORMAL_95 * std / self.tolerance, np.inf)
        return self.shares_with(self.prediction_percent, half)

    def shares_with(self, band_percent: Mapping[str, float], half: FloatArray) -> Mapping[str, float]:
        """Return ``share`` for given output bands and given half-widths over tolerance (8,)."""
        bands = {name: percent / self.tolerance_percent for name, percent in band_percent.items()}
        return bands | {name: float(half[PARAMETERS.index(name)]) for name in self.named}

    def common_after(self, more: int) -> FloatArray:
        """Return the variances (8,) due to the instruments' errors after ``more`` manoeuvres."""
        common = np.diag(self.posterior.common)
        return common if self.given is None else common * self.given.stays(1.0 + more / self.usable)

    @property
    def percent(self) -> float:
        """Stop criterion of the rule in percent: the largest `share`. The stop criterion holds below 100
        percent."""
        return 100.0 * max(self.share.values(), default=float("inf"))

    @property
    def holding_back(self) -> str:
        """Output or parameter with the largest `share`, which delays the stop."""
        share = self.share
        return max(share, key=lambda name: share[name], default="")

    @property
    def sufficient(self) -> bool:
        """Whether the stop criterion of this rule holds."""
        return self.predicted and self.percent < 100.0


def knowledge(usable: Sequence[CandidateManeuver], plan: CampaignPlan) -> Knowledge:
    """Return the knowledge after at least one usable manoeuvre, in the order flown."""
    estimates = estimates_of(usable)
    posteriors, airspeed = posteriors_at_one_speed(estimates), common_airspeed(estimates)
    posterior, widening, left_out = consensus(posteriors, plan)
    agreeing = [flown for i, flown in enumerate(usable) if i not in left_out]
    surprise, missed, foretold = _compared(usable[-1], posteriors, airspeed, plan)
    used = estimates_of(agreeing)
    prediction = predict(agreeing, posterior.shared.theta, airspeed)
    return Knowledge(
        posterior=posterior,
        prediction=prediction,
        tolerance_percent=plan.tolerance_percent,
        named=plan.parameters,
        tolerance=tolerances(posterior.theta, prediction, plan),
        surprise=surprise,
        missed_percent=missed,
        foretold_percent=foretold,
        widening=widening,
        left_out=left_out,
        not_identifiable={
            name: reason
            for name, reason in used[-1].not_identifiable.items()
            if all(name in e.not_identifiable for e in used)
        },
        usable=len(usable),
        given=estimates[-1].given,
    )


def _compared(
    newest: CandidateManeuver,
    posteriors: Sequence[Posterior],
    airspeed_m_s: float | None,
    plan: CampaignPlan,
) -> tuple[float, float, float]:
    """Return ``surprise``, ``missed_percent`` and ``foretold_percent`` of the newest manoeuvre."""
    if len(posteriors) < 2:
        return float("nan"), float("nan"), float("nan")
    before, excess, _ = consensus(posteriors[:-1], plan)
    own: Shared = widened(posteriors[-1], excess).shared
    distance, dof = disagreement(before.shared, own)
    surprise = distance / float(chdtri(dof, SURPRISING)) if dof else float("nan")
    bands = predict([newest], before.shared.theta, airspeed_m_s).percent(before.shared.covariance)
    missed = missed_percent(newest, before.shared.theta, own.theta, airspeed_m_s)
    return surprise, missed, max(bands.values(), default=float("nan"))


SPOKEN = {"alpha": "angle of attack", "q": "pitch rate", "a_z": "normal acceleration"}
"""Name of each predicted output for people."""


def sentence(so_far: Knowledge, stop: bool) -> str:
    """Return the sentence about stop or continuation, with its reason."""
    if stop:
        return _stop(so_far)
    if so_far.percent >= 100.0:
        return f"CONTINUE: {_held_back(so_far)}."
    if np.isnan(so_far.surprise):
        return "CONTINUE: one manoeuvre cannot show its own error; the prediction of one more will show it."
    off = "" if np.isnan(so_far.missed_percent) else f" (off by {so_far.missed_percent:.0f} % of its peak)"
    return (
        f"CONTINUE: the newest manoeuvre was not predicted{off}, so one of them has a larger error than "
        "stated; one more shows which."
    )


def _stop(so_far: Knowledge) -> str:
    bands = so_far.prediction_percent
    within = [f"the response is known to {max(bands.values()):.1f} % of its peak"] if bands else []
    if so_far.named:
        within.append("each named derivative to its tolerance")
    return f"TEST COMPLETE: {', '.join(within)}, and the newest manoeuvre was predicted."


def _held_back(so_far: Knowledge) -> str:
    name, share = so_far.holding_back, 0.01 * so_far.percent
    if name in SPOKEN:
        if np.isinf(share):
            return f"the response in {SPOKEN[name]} cannot be predicted from these manoeuvres"
        size, limit = distinct_texts(share * so_far.tolerance_percent, so_far.tolerance_percent, 1)
        return f"the response in {SPOKEN[name]} is known only to {size} % of its peak (limit {limit} %)"
    if np.isinf(share):
        reason = so_far.not_identifiable.get(name, "cannot be estimated from these manoeuvres")
        return f"{symbol(name)} {reason.removesuffix('.')}"
    return f"the error of {symbol(name)} is {times_its_tolerance(share)}"


def times_its_tolerance(share: float) -> str:
    """Return an error over its tolerance in words: ``1.6 times its tolerance``."""
    times, _ = distinct_texts(share, 1.0, 1)
    return f"{times} times its tolerance"


def evidence(so_far: Knowledge) -> tuple[str, ...]:
    """Return the numbers behind the decision, one line each: bands and shares of the tolerances."""
    share = so_far.share
    bands = ", ".join(f"{SPOKEN[name]} {band:.1f} %" for name, band in so_far.prediction_percent.items())
    named = ", ".join(f"{symbol(name)} {100.0 * share[name]:.0f} %" for name in so_far.named)
    weak = ", ".join(symbol(PARAMETERS[k]) for k in DERIVATIVES if PARAMETERS[k] not in so_far.named)
    return tuple(
        f"{what}: {numbers}"
        for what, numbers in (
            (f"95 % band of the response, of its peak (limit {so_far.tolerance_percent:g} %)", bands),
            ("95 % interval, of its own tolerance (limit 100 %)", named),
            ("judged by the response alone", weak),
        )
        if numbers
    )


@dataclass(frozen=True, slots=True)
class Standing:
    """Result of the rule ``information`` after a number of usable manoeuvres."""

    percent: float
    """Stop criterion in percent, as in ``Knowledge.percent``."""
    sufficient: bool
    """Whether the rule's stop criterion held."""
    predicted: bool
    """Whether the earlier manoeuvres predicted the newest manoeuvre."""


class CriterionCourse:
    """Cache of one campaign's stop criterion under one plan. The cache changes no decision."""

    def __init__(self, plan: CampaignPlan) -> None:
        self.plan = plan
        """Stop criterion of the campaign."""
        self._flown: list[CandidateManeuver] = []
        self._standings: list[Standing] = []
        self._known: tuple[list[CandidateManeuver], Knowledge] | None = None

    def standing(self, usable: Sequence[CandidateManeuver]) -> Standing:
        """Return the rule's result after at least one usable manoeuvre, in the order flown."""
        n = len(usable)
        if not same(self._flown[:n], usable):
            self._follow(usable)
        return self._standings[n - 1]

    def knowledge(self, usable: Sequence[CandidateManeuver]) -> Knowledge:
        """Return the knowledge after at least one usable manoeuvre. The newest result is cached."""
        if self._known is None or not same(self._known[0], usable):
            self._known = list(usable), knowledge(usable, self.plan)
        return self._known[1]

    def _follow(self, usable: Sequence[CandidateManeuver]) -> None:
        pairs = enumerate(zip(self._flown, usable, strict=False))
        kept = next((k for k, (mine, theirs) in pairs if mine is not theirs), len(self._flown))
        del self._flown[kept:], self._standings[kept:]
        for k in range(kept, len(usable)):
            knowledge = self.knowledge(usable[: k + 1])
            self._flown.append(usable[k])
            self._standings.append(Standing(knowledge.percent, knowledge.sufficient, knowledge.predicted))


def same(mine: Sequence[object], theirs: Sequence[object]) -> bool:
    """Return whether two sequences contain identical objects."""
    return len(mine) == len(theirs) and all(map(is_, mine, theirs))
