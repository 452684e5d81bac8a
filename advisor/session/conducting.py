"""Interface between the screens and the conductor of the campaign, in this process or another."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from advisor.campaign.state import CampaignState
from advisor.session.hand import HandDecision
from advisor.session.source import LinkHealth, LinkRequest, Playback, Tempo
from advisor.words.problems import Problem


@dataclass(frozen=True, slots=True, eq=False)
class SessionReport:
    """State of the campaign, the link and the replay at one moment."""

    state: CampaignState
    health: LinkHealth
    playback: Playback | None
    log: tuple[str, ...]
    """Sentences of the event log, oldest first."""
    problems: tuple[Problem, ...] = ()
    """Reasons for which nothing can be judged, while nothing has been judged."""

    def grown_old(self, who: str, age_s: float) -> "SessionReport":
        """Return the report with a warning of its age.

        Parameters
        ----------
        who
            Process that does not answer.
        age_s
            Age of the report, s.
        """
        sentence = f"{who} NOT ANSWERING for {age_s:.0f} s: what stands below is old"
        health = replace(self.health, condition="stale", sentence=sentence, alarm=sentence)
        return replace(self, health=health)


Tell = Callable[[SessionReport], object]


class Conducting(Protocol):
    """Runs a campaign over a source. Every method except ``run`` returns at once, before its request is
    done."""

    def run(self, tell: Tell) -> None:
        """Work until `stop`, in the calling thread. ``tell`` receives every report.

        Raises
        ------
        UnusableInputError
            The input can never serve.
        """

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""

    def decide(self, decision: HandDecision) -> None:
        """Exclude, include, note, mark, begin or end a marked manoeuvre."""

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link."""

    def jump(self, number: int) -> None:
        """Play on to just before a manoeuvre, or play to it from the beginning."""

    def seek(self, position_s: float) -> None:
        """Play on to a position of the replay, s, or play to it from the beginning."""

    def play(self, tempo: Tempo) -> None:
        """Pause a replay, continue it, or change its speed."""

    def step(self) -> None:
        """Play the next tenth of a second of a paused replay."""
