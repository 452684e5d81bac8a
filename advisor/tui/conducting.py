"""What the screens ask of whoever conducts the campaign, be it here or in a process of its own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from advisor.campaign.state import CampaignState
from advisor.problems import Problem
from advisor.tui.hand import HandDecision
from advisor.tui.source import LinkHealth, Order, Playback, Tempo


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One moment of the campaign, the link and the replay."""

    state: CampaignState
    health: LinkHealth
    playback: Playback | None
    log: tuple[str, ...]
    """What happened so far, oldest first."""
    problems: tuple[Problem, ...] = ()
    """Why nothing can be judged, while nothing has been."""


Tell = Callable[[Report], object]


class Conducting(Protocol):
    """Runs a campaign over a source. All but ``run`` return at once, before what they ask for is done."""

    def run(self, tell: Tell) -> None:
        """Work until `stop`, in the calling thread; ``tell`` receives every report.

        Raises
        ------
        UnusableInputError
            When the input can never serve.
        """

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""

    def decide(self, decision: HandDecision) -> None:
        """Exclude, include, note, mark, begin or end a marked manoeuvre."""

    def order(self, order: Order) -> None:
        """Do what a crew wants of the link."""

    def jump(self, number: int) -> None:
        """Play on, or from the beginning, to just before a manoeuvre."""

    def play(self, tempo: Tempo) -> None:
        """Hold a replay, let it go on, faster or slower."""

    def step(self) -> None:
        """Play the next tenth of a second of a held replay."""
