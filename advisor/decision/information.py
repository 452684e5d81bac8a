"""The rule ``information``: stop when further manoeuvres change nothing relevant.

The paper's criterion asks whether the last estimates scatter little relative to their mean. The scatter ratio
has no scale for a parameter near zero, and ignores all manoeuvres outside its window. The rule
``information`` asks three questions about the model's use. Is the 95 % band of the predicted response within
the tolerance? Did the earlier manoeuvres predict the newest manoeuvre? Is each derivative with a tolerance
from the crew within that tolerance? A parameter without its own tolerance that changes no prediction delays
no stop.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.consistency import consensus, widened
from advisor.decision.history import CandidateManeuver, estimates_of
from advisor.decision.pooling import (
    DERIVATIVES,
    Posterior,
    Shared,
    common_airspeed,
    disagreement,
    posteriors_at_one_speed,
)
from advisor.decision.prediction import Prediction, missed_percent, predict
from advisor.decision.tolerance import tolerances
from advisor.oem.known_instruments import FoundInstruments
from advisor.process.arrays import FloatArray
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol

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
