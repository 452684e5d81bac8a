"""The rule ``information``: narrow enough, and able to predict the next manoeuvre.

The paper's criterion asks whether the last estimates scatter little beside their mean. That has no
scale where a parameter is near zero, and it forgets every manoeuvre outside its window. This rule asks
what the crew wants to know: is the 95 % interval of every parameter, from all usable manoeuvres
together, narrower than the tolerance, and did the estimate predict the newest manoeuvre before it had
used it?
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.consistency import consensus, widened
from advisor.decision.pooling import Belief, beliefs_at_one_speed, disagreement
from advisor.decision.tolerance import tolerances
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate

Z95 = 1.959963984540054
"""Half-width of a 95 % interval in standard deviations."""
SURPRISING = 0.01
"""Chance level below which a manoeuvre counts as not predicted."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """How well the aircraft is known after some manoeuvres."""

    belief: Belief
    """From all manoeuvres that agree; wider when they scatter more than their intervals say."""
    tolerance: FloatArray
    """Shape (8,). What each 95 % half-width must stay below."""
    predicted: bool
    """Whether the manoeuvres before the newest predicted it; False while there is only one."""
    surprise: float
    """Distance of the newest from its prediction, as a share of the 99 % limit; NaN without one."""
    widening: float
    """Variance ratio by which contradictions between manoeuvres have widened ``belief``, at least 1."""
    left_out: tuple[int, ...]
    """Indices of manoeuvres that contradict all the others."""
    not_identifiable: Mapping[str, str]
    """Parameter to the reason, where no manoeuvre could tell it: a small error is then no knowledge."""

    @property
    def share(self) -> FloatArray:
        """Shape (8,). Half-width of each 95 % interval as a share of its tolerance; infinite when unknown."""
        known = np.isfinite(self.belief.std) & np.isfinite(self.belief.theta)
        known &= [name not in self.not_identifiable for name in PARAMETERS]
        return np.where(known, Z95 * np.where(known, self.belief.std, 0.0) / self.tolerance, np.inf)

    @property
    def percent(self) -> float:
        """The criterion: the largest `share`, in percent; stop below 100."""
        return 100.0 * float(np.max(self.share))

    @property
    def holding_back(self) -> str:
        """The parameter with the largest `share`."""
        return PARAMETERS[int(np.argmax(self.share))]

    @property
    def sufficient(self) -> bool:
        """Whether this rule says stop."""
        return self.predicted and self.percent < 100.0


def knowledge(estimates: Sequence[Estimate], plan: CampaignPlan) -> Knowledge:
    """What is known after the usable manoeuvres ``estimates`` (at least one), in the order flown."""
    beliefs = beliefs_at_one_speed(estimates)
    belief, widening, left_out = consensus(beliefs)
    predicted, surprise = False, float("nan")
    if len(beliefs) > 1:
        before, excess, _ = consensus(beliefs[:-1])
        distance, dof = disagreement(before.shared, widened(beliefs[-1], excess).shared)
        surprise = distance / float(chdtri(dof, SURPRISING)) if dof else float("nan")
        predicted = surprise < 1.0
    agreeing = [e for i, e in enumerate(estimates) if i not in left_out]
    return Knowledge(
        belief,
        tolerances(belief.theta, agreeing[0], plan),
        predicted,
        surprise,
        widening,
        left_out,
        {
            name: reason
            for name, reason in agreeing[-1].not_identifiable.items()
            if all(name in e.not_identifiable for e in agreeing)
        },
    )
