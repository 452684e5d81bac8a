"""What an engineer decides by hand, kept so that a replay started again repeats it."""

from dataclasses import dataclass
from typing import Literal

from advisor.campaign_state import CampaignState
from advisor.tui.campaign_like import CampaignLike

Verb = Literal["exclude", "include", "note", "mark"]


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with its reason."""

    verb: Verb
    text: str
    """The reason, the note or the mark's name."""
    number: int = 0
    """The manoeuvre it is about; 0 for a mark."""
    at_s: float = 0.0
    """Vehicle time at which a mark was set."""

    def due(self, state: CampaignState) -> bool:
        """Whether the flight has come to what the decision is about."""
        if self.verb == "mark":
            return state.now_s >= self.at_s
        return any(judged.maneuver.number == self.number for judged in state.maneuvers)

    def apply(self, campaign: CampaignLike) -> None:
        """Tell the campaign, which recomputes every decision that follows from it."""
        if self.verb == "exclude":
            campaign.exclude(self.number, self.text)
        elif self.verb == "include":
            campaign.include(self.number)
            campaign.note(self.number, f"included again: {self.text}")
        elif self.verb == "note":
            campaign.note(self.number, self.text)
        else:
            campaign.mark(self.text)
