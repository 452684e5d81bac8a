"""Interface between the screens and the conductor of the campaign.

Between processes a report holds only the fields that have changed since the last report.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from advisor.campaign.hand_decisions import HandDecision
from advisor.campaign.state import AxisState, CampaignState, JudgedManeuver
from advisor.decision.verdict import ManeuverVerdict
from advisor.session.source import LinkHealth, LinkRequest, Playback, Tempo
from advisor.words.axes import AxisName
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
    """Reasons why no manoeuvre can be judged; empty after the first verdict."""

    def grown_old(self, who: str, age_s: float) -> "SessionReport":
        sentence = f"{who} NOT ANSWERING for {age_s:.0f} s: the values below are old"
        health = replace(self.health, condition="stale", sentence=sentence, alarm=sentence)
        return replace(self, health=health)


Tell = Callable[[SessionReport], object]


class Conducting(ABC):
    """Runs a campaign over a source. Every method except ``run`` returns before its request is done."""

    @abstractmethod
    def run(self, tell: Tell) -> None:
        """Run the campaign until `stop`, in the calling thread. ``tell`` is called with every report.

        Raises
        ------
        UnusableInputError
            The data of the log or link can never be sufficient.
        """

    @abstractmethod
    def stop(self) -> None:
        """End ``run`` at the next possible moment."""

    @abstractmethod
    def ask(self, name: str, *arguments: object) -> None:
        """Send a request: the name of a method below, and its arguments."""

    def decide(self, decision: HandDecision) -> None:
        """Exclude, include, note, mark, begin or end a marked manoeuvre."""
        self.ask("decide", decision)

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link."""
        self.ask("order", order)

    def jump(self, number: int) -> None:
        """Play forward to just before a manoeuvre, or play there from the beginning."""
        self.ask("jump", number)

    def seek(self, position_s: float) -> None:
        """Play forward to a position of the replay, s, or play there from the beginning."""
        self.ask("seek", position_s)

    def play(self, tempo: Tempo) -> None:
        """Pause a replay, continue it, or change its speed."""
        self.ask("play", tempo)

    def step(self) -> None:
        """Play the next tenth of a second of a paused replay."""
        self.ask("step")


@dataclass(frozen=True, slots=True)
class Again:
    """A manoeuvre that was sent earlier, with a new verdict. The samples and the estimate of the manoeuvre
    are unchanged."""

    index: int
    verdict: ManeuverVerdict
    excluded_because: str | None
    notes: tuple[str, ...]

    @classmethod
    def of(cls, index: int, judged: JudgedManeuver) -> "Again":
        return cls(index, judged.verdict, judged.excluded_because, judged.notes)

    def applied_to(self, maneuvers: Sequence[JudgedManeuver]) -> JudgedManeuver:
        """Return the manoeuvre with the new verdict; the identical object if the verdict is unchanged."""
        last = maneuvers[self.index]
        if self == Again.of(self.index, last):
            return last
        return replace(last, verdict=self.verdict, excluded_because=self.excluded_because, notes=self.notes)


@dataclass(frozen=True, slots=True)
class AxisChanges:
    """Fields of the state of one axis whose object differs from the earlier state's."""

    fields: dict[str, Any]
    maneuvers: tuple[JudgedManeuver | Again, ...] | None
    """The manoeuvres with new data or verdicts. None if no manoeuvre was judged."""

    @classmethod
    def of(cls, before: AxisState[Any], now: AxisState[Any]) -> "AxisChanges | None":
        """Return the changes that turn one state into another; None without changes."""
        sent = None
        if now.maneuvers is not before.maneuvers:
            sent = tuple(_sent(before.maneuvers, k, judged) for k, judged in enumerate(now.maneuvers))
        others = _changed(before, now, {"maneuvers"})
        return None if sent is None and not others else cls(others, sent)

    def applied_to(self, last: AxisState[Any]) -> AxisState[Any]:
        """Return the newer state, from the earlier one and its changes."""
        if self.maneuvers is None:
            return replace(last, **self.fields)
        maneuvers = tuple(
            sent.applied_to(last.maneuvers) if isinstance(sent, Again) else sent for sent in self.maneuvers
        )
        return replace(last, maneuvers=maneuvers, **self.fields)


@dataclass(frozen=True, slots=True)
class Changes:
    """Fields of a report whose object differs from the earlier report's.

    The samples of a manoeuvre are sent once instead of with every report. The receiver keeps the identical
    objects of unchanged fields. Panes recognise unchanged fields by identity and do not paint them again.
    """

    report: dict[str, Any]
    state: dict[str, Any]
    axes: Mapping[AxisName, AxisChanges | AxisState[Any]]
    """Changes of each axis; the whole state of an axis that the earlier report lacks."""

    def applied_to(self, last: SessionReport) -> SessionReport:
        """Return the newer report, from the earlier one and its changes."""
        before = last.state.axes
        axes = {
            axis: sent.applied_to(before[axis]) if isinstance(sent, AxisChanges) else sent
            for axis, sent in self.axes.items()
        }
        state = replace(last.state, **self.state, axes={**before, **axes} if axes else before)
        return replace(last, **self.report, state=state)


def changes(last: SessionReport, report: SessionReport) -> Changes:
    """Return the changes that turn ``last`` into ``report``. The state's notices are in the report's log."""
    before = last.state.axes
    made = {
        axis: AxisChanges.of(before[axis], now) if axis in before else now
        for axis, now in report.state.axes.items()
    }
    return Changes(
        _changed(last, report, {"state"}),
        _changed(last.state, report.state, {"notices", "axes"}),
        {axis: change for axis, change in made.items() if change is not None},
    )


def _sent(before: Sequence[JudgedManeuver], index: int, judged: JudgedManeuver) -> JudgedManeuver | Again:
    if index < len(before):
        last = before[index]
        if judged.maneuver is last.maneuver and judged.estimate is last.estimate:
            return Again.of(index, judged)
    return judged


def _changed(old: Any, new: Any, without: set[str]) -> dict[str, Any]:
    pairs = {
        f.name: (getattr(old, f.name), getattr(new, f.name)) for f in fields(new) if f.name not in without
    }
    return {name: after for name, (before, after) in pairs.items() if after is not before}
