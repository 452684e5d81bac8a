"""Decision by hand, on its way from a key to the campaign."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from advisor.campaign.state import AxisName, CampaignState

if TYPE_CHECKING:
    from advisor.campaign.campaign import Campaign


Verb = Literal["exclude", "include", "note", "mark", "begin", "end"]
"""Kind of decision by hand: ``mark`` names a moment in the log; ``begin`` and ``end`` mark a manoeuvre."""


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with the engineer's reason."""

    verb: Verb
    text: str = ""
    """Text of the decision: a reason, a note or the name of the moment."""
    number: int = 0
    """Number of the manoeuvre; 0 for a decision on the present moment."""
    axis: AxisName = "pitch"
    """Axis of the manoeuvre."""

    def due(self, state: CampaignState) -> bool:
        """Return whether the flight has reached the manoeuvre or moment of the decision."""
        side = state.lateral.maneuvers if state.lateral is not None else ()
        flown = side if self.axis == "lateral" else state.maneuvers
        return self.number == 0 or any(judged.maneuver.number == self.number for judged in flown)

    def apply(self, campaign: "Campaign") -> None:
        """Apply the decision to the campaign, which recomputes every dependent decision."""
        if self.verb == "exclude":
            campaign.engineer.exclude(self.number, self.text, self.axis)
        elif self.verb == "include":
            campaign.engineer.include(self.number, self.axis)
            campaign.engineer.note(self.number, f"included again: {self.text}", self.axis)
        elif self.verb == "note":
            campaign.engineer.note(self.number, self.text, self.axis)
        elif self.verb == "mark":
            campaign.engineer.mark(self.text)
        elif self.verb == "begin":
            campaign.engineer.begin_maneuver()
        else:
            campaign.engineer.end_maneuver()
