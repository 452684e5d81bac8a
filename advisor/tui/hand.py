"""What an engineer decides by hand, on its way from a key to the campaign."""

from dataclasses import dataclass
from typing import Literal

from advisor.campaign.state import CampaignState
from advisor.tui.campaign_like import CampaignLike

Verb = Literal["exclude", "include", "note", "mark", "begin", "end"]
"""``mark`` names a moment in the log; ``begin`` and ``end`` mark a manoeuvre."""


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with its reason."""

    verb: Verb
    text: str = ""
    """The reason, the note or the moment's name."""
    number: int = 0
    """The manoeuvre it is about; 0 where it is about the present moment."""

    def due(self, state: CampaignState) -> bool:
        """Whether the flight has come to what the decision is about."""
        return self.number == 0 or any(judged.maneuver.number == self.number for judged in state.maneuvers)

    def apply(self, campaign: CampaignLike) -> None:
        """Tell the campaign, which recomputes every decision that follows from it."""
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
