"""Decision by hand, on its way from a key to the campaign."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.state import AxisName, CampaignState
from advisor.flight.signals.messages import Columns
from advisor.words.problems import Problem


class CampaignLike(Protocol):
    """The part of `advisor.campaign.Campaign` that the screens use."""

    @property
    def by_hand(self) -> ByHand:
        """The engineer's decisions by hand so far."""

    @property
    def state(self) -> CampaignState:
        """State of the campaign for the screens."""

    @property
    def problems(self) -> Sequence[Problem]:
        """Reasons for which the stream so far cannot be used."""

    def feed(self, columns: Sequence[Columns]) -> Sequence[object]:
        """Process the next messages."""

    def finish(self) -> Sequence[object]:
        """End the stream, and judge open manoeuvres."""

    def exclude(self, number: int, because: str, axis: AxisName = "pitch") -> None:
        """Exclude a manoeuvre from every decision."""

    def include(self, number: int, axis: AxisName = "pitch") -> None:
        """Include an excluded manoeuvre again."""

    def mark(self, text: str) -> None:
        """Set a mark at the present moment."""

    def begin_maneuver(self) -> None:
        """Begin a manoeuvre's mark at the present moment."""

    def end_maneuver(self) -> None:
        """End the mark of a manoeuvre at the present moment."""

    def log(self, sentence: str) -> None:
        """Write a sentence into the event log at the present moment."""

    def note(self, number: int, text: str, axis: AxisName = "pitch") -> None:
        """Add a note to a manoeuvre."""


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

    def apply(self, campaign: CampaignLike) -> None:
        """Apply the decision to the campaign, which recomputes every dependent decision."""
        if self.verb == "exclude":
            campaign.exclude(self.number, self.text, self.axis)
        elif self.verb == "include":
            campaign.include(self.number, self.axis)
            campaign.note(self.number, f"included again: {self.text}", self.axis)
        elif self.verb == "note":
            campaign.note(self.number, self.text, self.axis)
        elif self.verb == "mark":
            campaign.mark(self.text)
        elif self.verb == "begin":
            campaign.begin_maneuver()
        else:
            campaign.end_maneuver()
