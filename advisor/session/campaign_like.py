"""Interface between the screens and a campaign, so that tests may bring their own campaign."""

from collections.abc import Sequence
from typing import Protocol

from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.state import CampaignState
from advisor.flight.signals.messages import Columns
from advisor.words.problems import Problem


class CampaignLike(Protocol):
    """The part of `advisor.campaign.Campaign` that the screens use."""

    @property
    def by_hand(self) -> ByHand:
        """All decisions by hand so far."""

    @property
    def state(self) -> CampaignState:
        """State of the campaign for the screens."""

    @property
    def problems(self) -> Sequence[Problem]:
        """Reasons for which the stream so far cannot be used."""

    def feed(self, columns: Sequence[Columns]) -> Sequence[object]:
        """Take the next messages."""

    def finish(self) -> Sequence[object]:
        """Take the end of the stream, and judge open manoeuvres."""

    def exclude(self, number: int, because: str) -> None:
        """Exclude a manoeuvre from every decision."""

    def include(self, number: int) -> None:
        """Include an excluded manoeuvre again."""

    def mark(self, text: str) -> None:
        """Set a mark at the present moment."""

    def begin_maneuver(self) -> None:
        """Begin a manoeuvre's mark at the present moment."""

    def end_maneuver(self) -> None:
        """End the mark of a manoeuvre at the present moment."""

    def log(self, sentence: str) -> None:
        """Write a sentence into the event log at the present moment."""

    def note(self, number: int, text: str) -> None:
        """Add a note to a manoeuvre."""
