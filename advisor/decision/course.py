"""Criterion of the rule ``information`` after each manoeuvre, cached between decisions.

The knowledge after k manoeuvres depends on these k manoeuvres only. A decision after one more manoeuvre adds
one entry to the cache. An excluded, included or re-assessed manoeuvre invalidates its own entry in the cache
and all later entries.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import is_

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import Knowledge, knowledge


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
