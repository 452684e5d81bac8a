"""What the screens need of a campaign, so that tests may bring their own."""

from collections.abc import Sequence
from typing import Protocol

from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.state import CampaignState
from advisor.flight.messages import Columns
from advisor.problems import Problem


class CampaignLike(Protocol):
    """The part of `advisor.campaign.Campaign` that is used here."""

    @property
    def by_hand(self) -> ByHand:
        """Everything that has been decided by hand."""

    @property
    def state(self) -> CampaignState:
        """Everything a face may show."""

    @property
    def problems(self) -> Sequence[Problem]:
        """Why this stream cannot be used, as far as it has been heard."""

    def feed(self, columns: Sequence[Columns]) -> Sequence[object]:
        """Take the next messages."""

    def finish(self) -> Sequence[object]:
        """The stream has ended: judge what is still open."""

    def exclude(self, number: int, because: str) -> None:
        """Take a manoeuvre out of every decision."""

    def include(self, number: int) -> None:
        """Take it in again."""

    def mark(self, text: str) -> None:
        """Set a mark at the present moment."""

    def begin_maneuver(self) -> None:
        """Mark a manoeuvre from the present moment on."""

    def end_maneuver(self) -> None:
        """End the mark of a manoeuvre at the present moment."""

    def log(self, sentence: str) -> None:
        """Write a sentence into the event log at the present moment."""

    def note(self, number: int, text: str) -> None:
        """Add a note to a manoeuvre."""
