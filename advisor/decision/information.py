"""The rule ``information``: stop when further manoeuvres change nothing that matters, and its words.

The paper's criterion asks whether the last estimates scatter little relative to their mean. That ratio has no
scale where a parameter is near zero, and it ignores every manoeuvre outside its window. The rule
``information`` asks three questions about the use of the model. Is the 95 % band of the predicted response
within the tolerance? Was the newest manoeuvre predicted before the estimate had used it? Is each derivative
that the crew named within its own tolerance? A parameter that moves no prediction and is not named delays no
stop.
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
from advisor.flight.signals.messages import FloatArray
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol

SURPRISING = 0.01
"""Probability below which a manoeuvre contradicts its prediction."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """Knowledge of the aircraft after some manoeuvres."""

    posterior: Posterior
    """Pooled estimate of all consistent manoeuvres, wider where they scatter beyond their errors."""
    prediction: Prediction
    """Predicted response to the flown inputs."""
    tolerance_percent: float
    """Tolerance for the half-width of the prediction's 95 % band, % of the response's peak."""
    named: tuple[str, ...]
    """Parameters that have a tolerance of their own."""
    tolerance: FloatArray
    """Shape (8,). Tolerance for the 95 % half-width of each named parameter."""
    surprise: float
    """Distance of the newest manoeuvre from its prediction, as a share of the 99 % limit. NaN without one."""
    missed_percent: float
    """Largest error of the newest manoeuvre's prediction, % of the response's peak. NaN without one."""
    foretold_percent: float
    """Half-width of the 95 % band of the newest manoeuvre's prediction, % of its peak. NaN without one."""
    widening: float
    """Variance ratio by which contradictions between manoeuvres have widened ``posterior``, at least 1."""
    left_out: tuple[int, ...]
    """Indices of manoeuvres that contradict all the others."""
    not_identifiable: Mapping[str, str]
    """Parameter to the reason for which no manoeuvre identifies it. Small errors of such parameters are no
    knowledge."""

    @property
    def predicted(self) -> bool:
        """Whether the earlier manoeuvres predicted the newest.

        Either the error of the predicted response is within the tolerance. Such a small error of the model,
        which no interval of a long campaign contains, does not delay the stop. Or chance explains the error,
        and the prediction was more precise than the tolerance. An imprecise one would agree with all.
        """
        unsure = self.foretold_percent >= self.tolerance_percent
        return self.missed_percent < self.tolerance_percent or (self.surprise < 1.0 and not unsure)

    @property
    def prediction_percent(self) -> Mapping[str, float]:
        """Output to the largest half-width of its 95 % band, % of its peak."""
        return self.prediction.percent(self.posterior.shared.covariance)

    @property
    def share(self) -> Mapping[str, float]:
        """Criterion's quantity to its uncertainty as a share of its tolerance. Infinite where unknown.

        The quantities are the outputs by their names, then the named parameters.
        """
        known = np.isfinite(self.posterior.std) & np.isfinite(self.posterior.theta)
        known &= [name not in self.not_identifiable for name in PARAMETERS]
        half = np.where(known, NORMAL_95 * np.where(known, self.posterior.std, 0.0) / self.tolerance, np.inf)
        return self.shares_with(self.prediction_percent, half)

    def shares_with(self, band_percent: Mapping[str, float], half: FloatArray) -> Mapping[str, float]:
        """Return ``share`` for given bands of the outputs, and given (8,) half-widths over tolerance."""
        bands = {name: percent / self.tolerance_percent for name, percent in band_percent.items()}
        return bands | {name: float(half[PARAMETERS.index(name)]) for name in self.named}

    @property
    def percent(self) -> float:
        """Criterion of the rule: the largest `share`, in percent. Below 100 the rule says stop."""
        return 100.0 * max(self.share.values(), default=float("inf"))

    @property
    def holding_back(self) -> str:
        """Output or parameter with the largest `share`, which delays the stop."""
        share = self.share
        return max(share, key=lambda name: share[name], default="")

    @property
    def sufficient(self) -> bool:
        """Whether this rule says stop."""
        return self.predicted and self.percent < 100.0


def knowledge(usable: Sequence[CandidateManeuver], plan: CampaignPlan) -> Knowledge:
    """Return the knowledge after at least one usable manoeuvre, in the order flown."""
    estimates = estimates_of(usable)
    posteriors, airspeed = posteriors_at_one_speed(estimates), common_airspeed(estimates)
    posterior, widening, left_out = consensus(posteriors)
    agreeing = [flown for i, flown in enumerate(usable) if i not in left_out]
    surprise, missed, foretold = _compared(usable[-1], posteriors, airspeed)
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
    )


def _compared(
    newest: CandidateManeuver, posteriors: Sequence[Posterior], airspeed_m_s: float | None
) -> tuple[float, float, float]:
    """Return the comparison of the newest manoeuvre with its prediction: ``surprise``, ``missed_percent``,
    ``foretold_percent``."""
    if len(posteriors) < 2:
        return float("nan"), float("nan"), float("nan")
    before, excess, _ = consensus(posteriors[:-1])
    own: Shared = widened(posteriors[-1], excess).shared
    distance, dof = disagreement(before.shared, own)
    surprise = distance / float(chdtri(dof, SURPRISING)) if dof else float("nan")
    bands = predict([newest], before.shared.theta, airspeed_m_s).percent(before.shared.covariance)
    missed = missed_percent(newest, before.shared.theta, own.theta, airspeed_m_s)
    return surprise, missed, max(bands.values(), default=float("nan"))


SPOKEN = {"alpha": "angle of attack", "q": "pitch rate", "a_z": "normal acceleration"}
"""Predicted output to its name for people."""


def sentence(known: Knowledge, stop: bool) -> str:
    """Return the sentence on stop or continue, with its reason."""
    if stop:
        return _stop(known)
    if known.percent >= 100.0:
        return f"CONTINUE: {_held_back(known)}."
    if np.isnan(known.surprise):
        return "CONTINUE: sure enough; one more manoeuvre to check the prediction."
    off = "" if np.isnan(known.missed_percent) else f" (off by {known.missed_percent:.0f} % of its peak)"
    return (
        f"CONTINUE: sure enough, but the newest manoeuvre was not predicted{off}; one more shows which is "
        "right."
    )


def _stop(known: Knowledge) -> str:
    bands = known.prediction_percent
    within = [f"the response is known to {max(bands.values()):.1f} % of its peak"] if bands else []
    if known.named:
        within.append("each named derivative to its tolerance")
    return f"TEST COMPLETE: {', '.join(within)}, and the newest manoeuvre was predicted."


def _held_back(known: Knowledge) -> str:
    name, share = known.holding_back, 0.01 * known.percent
    times, _ = distinct_texts(share, 1.0, 1)
    if name in SPOKEN:
        if np.isinf(share):
            return f"the response in {SPOKEN[name]} cannot be predicted from these manoeuvres"
        size, limit = distinct_texts(share * known.tolerance_percent, known.tolerance_percent, 1)
        return f"the response in {SPOKEN[name]} is known only to {size} % of its peak (limit {limit} %)"
    if np.isinf(share):
        reason = known.not_identifiable.get(name, "cannot be estimated from these manoeuvres")
        return f"{symbol(name)} {reason.removesuffix('.')}"
    return f"the error of {symbol(name)} is {times} times its tolerance"


def evidence(known: Knowledge) -> tuple[str, ...]:
    """Return the numbers of the decision, one line each: bands, shares of the tolerances, and the parameters
    without one."""
    share = known.share
    bands = ", ".join(f"{SPOKEN[name]} {band:.1f} %" for name, band in known.prediction_percent.items())
    named = ", ".join(f"{symbol(name)} {100.0 * share[name]:.0f} %" for name in known.named)
    weak = ", ".join(symbol(PARAMETERS[k]) for k in DERIVATIVES if PARAMETERS[k] not in known.named)
    return tuple(
        f"{what}: {numbers}"
        for what, numbers in (
            (f"95 % band of the response, of its peak (limit {known.tolerance_percent:g} %)", bands),
            ("95 % interval, of its own tolerance (limit 100 %)", named),
            ("judged by the response alone", weak),
        )
        if numbers
    )
