"""Decision by hand, on its way from a key to the campaign."""

from dataclasses import dataclass
from typing import Literal

from advisor.campaign.state import CampaignState
from advisor.session.campaign_like import CampaignLike

Verb = Literal["exclude", "include", "note", "mark", "begin", "end"]
"""Kind of decision: ``mark`` names a moment in the log; ``begin`` and ``end`` mark a manoeuvre."""


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with its reason."""

    verb: Verb
    text: str = ""
    """Reason, note or name of the moment."""
    number: int = 0
    """Number of the manoeuvre. 0 for a decision on the present moment."""

    def due(self, state: CampaignState) -> bool:
        """Return whether the flight has reached the subject of the decision."""
        return self.number == 0 or any(judged.maneuver.number == self.number for judged in state.maneuvers)

    def apply(self, campaign: CampaignLike) -> None:
        """Apply the decision to the campaign, which recomputes every dependent decision."""
        if self.verb == "exclude":
            campaign.exclude(self.number, self.text)
        elif self.verb == "include":
            campaign.include(self.number)
            campaign.note(self.number, f"included again: {self.text}")
        elif self.verb == "note":
            campaign.note(self.number, self.text)
        elif self.verb == "mark":
            campaign.mark(self.text)
        elif self.verb == "begin":
            campaign.begin_maneuver()
        else:
            campaign.end_maneuver()
