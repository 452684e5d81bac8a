"""The rule ``information``: stop when flying more changes nothing that matters.

The paper's criterion asks whether the last estimates scatter little beside their mean. That has no
scale where a parameter is near zero, and it forgets every manoeuvre outside its window. This rule asks
what the model is for. Is the 95 % band of the predicted response within the tolerance? Was the newest
manoeuvre predicted before the estimate had used it? Is each derivative that the crew named within its
own tolerance? A parameter that moves no prediction and is not named holds nobody up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.consistency import consensus, widened
from advisor.decision.history import Flown, estimates_of
from advisor.decision.pooling import Belief, Shared, beliefs_at_one_speed, common_airspeed, disagreement
from advisor.decision.prediction import Z95, Prediction, missed_percent, predict
from advisor.decision.tolerance import tolerances
from advisor.flight.messages import FloatArray

SURPRISING = 0.01
"""Chance level below which a manoeuvre contradicts its prediction."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """How well the aircraft is known after some manoeuvres."""

    belief: Belief
    """From all manoeuvres that agree; wider when they scatter more than their intervals say."""
    prediction: Prediction
    """The response to what was flown."""
    tolerance_percent: float
    """What the half-width of the band must stay below, in percent of the response's peak."""
    named: tuple[str, ...]
    """Parameters that have a tolerance of their own."""
    tolerance: FloatArray
    """Shape (8,). What the 95 % half-width of a named parameter must stay below."""
    surprise: float
    """Distance of the newest from its prediction, as a share of the 99 % limit; NaN without one."""
    missed_percent: float
    """Largest error of the newest's predicted response, in percent of its peak; NaN without one."""
    foretold_percent: float
    """The 95 % band of that prediction, in percent of its peak; NaN without one."""
    widening: float
    """Variance ratio by which contradictions between manoeuvres have widened ``belief``, at least 1."""
    left_out: tuple[int, ...]
    """Indices of manoeuvres that contradict all the others."""
    not_identifiable: Mapping[str, str]
    """Parameter to the reason, where no manoeuvre could tell it: a small error is then no knowledge."""

    @property
    def predicted(self) -> bool:
        """Whether the manoeuvres before predicted the newest.

        The predicted response came true within the tolerance: a small error of the model, which no interval
        of a long campaign contains, does not withhold the stop. Or chance explains the difference, and the
        prediction was surer than the tolerance: an unsure one agrees with anything.
        """
        unsure = self.foretold_percent >= self.tolerance_percent
        return self.missed_percent < self.tolerance_percent or (self.surprise < 1.0 and not unsure)

    @property
    def prediction_percent(self) -> Mapping[str, float]:
        """Output to the half-width of its 95 % band at the widest, in percent of its peak."""
        return self.prediction.percent(self.belief.shared.covariance)

    @property
    def share(self) -> Mapping[str, float]:
        """What must be known to its uncertainty as a share of its tolerance; infinite when unknown.

        Outputs by their name, then the named parameters.
        """
        known = np.isfinite(self.belief.std) & np.isfinite(self.belief.theta)
        known &= [name not in self.not_identifiable for name in PARAMETERS]
        half = np.where(known, Z95 * np.where(known, self.belief.std, 0.0) / self.tolerance, np.inf)
        return self.shares_with(self.prediction_percent, half)

    def shares_with(self, band_percent: Mapping[str, float], half: FloatArray) -> Mapping[str, float]:
        """As ``share``, for other bands and other (8,) half-widths over tolerance."""
        bands = {name: percent / self.tolerance_percent for name, percent in band_percent.items()}
        return bands | {name: float(half[PARAMETERS.index(name)]) for name in self.named}

    @property
    def percent(self) -> float:
        """The criterion: the largest `share`, in percent; stop below 100."""
        return 100.0 * max(self.share.values(), default=float("inf"))

    @property
    def holding_back(self) -> str:
        """The output or parameter with the largest `share`."""
        share = self.share
        return max(share, key=lambda name: share[name], default="")

    @property
    def sufficient(self) -> bool:
        """Whether this rule says stop."""
        return self.predicted and self.percent < 100.0


def knowledge(usable: Sequence[Flown], plan: CampaignPlan) -> Knowledge:
    """What is known after usable manoeuvres (at least one), in the order flown."""
    estimates = estimates_of(usable)
    beliefs, airspeed = beliefs_at_one_speed(estimates), common_airspeed(estimates)
    belief, widening, left_out = consensus(beliefs)
    agreeing = [flown for i, flown in enumerate(usable) if i not in left_out]
    surprise, missed, foretold = _compared(usable[-1], beliefs, airspeed)
    used = estimates_of(agreeing)
    prediction = predict(agreeing, belief.shared.theta, airspeed)
    return Knowledge(
        belief=belief,
        prediction=prediction,
        tolerance_percent=plan.tolerance_percent,
        named=plan.parameters,
        tolerance=tolerances(belief.theta, prediction, plan),
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
    newest: Flown, beliefs: Sequence[Belief], airspeed_m_s: float | None
) -> tuple[float, float, float]:
    """Return the newest manoeuvre against those before: ``surprise``, ``missed_percent``,
    ``foretold_percent``."""
    if len(beliefs) < 2:
        return float("nan"), float("nan"), float("nan")
    before, excess, _ = consensus(beliefs[:-1])
    own: Shared = widened(beliefs[-1], excess).shared
    distance, dof = disagreement(before.shared, own)
    surprise = distance / float(chdtri(dof, SURPRISING)) if dof else float("nan")
    bands = predict([newest], before.shared.theta, airspeed_m_s).percent(before.shared.covariance)
    missed = missed_percent(newest, before.shared.theta, own.theta, airspeed_m_s)
    return surprise, missed, max(bands.values(), default=float("nan"))
