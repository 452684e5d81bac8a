"""Interface between the screens and the conductor of the campaign: sources, views and reports.

Between processes a report holds only the fields that have changed since the last report.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import nan
from pathlib import Path
from typing import Any, Literal, Protocol

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import OF_ELEVATOR, AxisState, ByHand, CampaignState, HandDecision, JudgedManeuver
from advisor.decision.verdict import CrewPlan, FlightTestVerdict, ManeuverVerdict, limit_percent
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics
from advisor.oem.estimate import Estimate
from advisor.session.behind import backlog_s, behind_sentence
from advisor.words.axes import AXES, AxisName
from advisor.words.problems import Problem

Condition = Literal["good", "poor", "waiting", "lost", "stale", "ended"]
"""State of the arriving data. Stale: a process of the advisor does not answer, and all displayed data are
old."""


@dataclass(frozen=True, slots=True)
class LinkHealth:
    """State of the arriving data, in one word and in detail."""

    condition: Condition
    sentence: str
    """Sentence on the fault and its remedy, or on the faultless state."""
    figures: tuple[tuple[str, str], ...] = ()
    """Link statistics for the engineer: (name, value with unit)."""
    alarm: str = ""
    """Sentence on data that are being lost at this moment; empty if none are."""
    recording: str = ""
    """State of the recording with its size and the free disk space; empty for a log."""
    link: LinkStatistics | None = None
    """Statistics of the link. None for a log, and before the link is open."""
    read_to_s: float = nan
    """Host time of the newest record that the campaign received, seconds since 1970."""

    @property
    def behind_s(self) -> float:
        """Time between the newest judged record and the newest record of the link, s."""
        return backlog_s(self.link, self.read_to_s) if self.link is not None else 0.0

    @property
    def behind(self) -> str:
        """Sentence on a backlog that the crew must know; empty without such a backlog."""
        return behind_sentence(self.behind_s)


@dataclass(frozen=True, slots=True)
class LinkRequest:
    """A crew's request to the link."""

    what: Literal["follow", "outputs", "take"]
    """Kind of request: read another vehicle, ask for the elevator's output, or use an output as the
    elevator."""
    number: int = 0
    """System id of the vehicle to read, or number of the output."""


class Source(Protocol):
    """Delivers batches of columns in order of arrival. All calls except ``health`` come from one thread."""

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Wait at most ``timeout_s`` for the next batch; return an empty batch after that, or None at the
        end.

        Raises
        ------
        UnusableInputError
            The input can never be used. The message names the remedy.
        """

    def health(self) -> LinkHealth:
        """Return the state of the arriving data. Any thread may call."""

    def take_notices(self) -> Sequence[str]:
        """Return the notices since the last call: reconnected, rates granted, a second vehicle."""

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link. Sources without a link do nothing."""

    def keep(self, by_hand: ByHand) -> str:
        """Store the decisions by hand with the data; return a sentence on the file or the failure."""

    def close(self) -> None:
        """Release sockets and files."""


@dataclass(frozen=True, slots=True)
class Tempo:
    """Tempo of a replay."""

    paused: bool = False
    speed: float = 1.0
    """Multiple of real time. Infinite: as fast as possible."""


@dataclass(frozen=True, slots=True)
class Playback:
    """Position of a replay."""

    position_s: float
    """Time since the first record with silences shortened, s."""
    duration_s: float
    """Length of the replay with silences shortened, s."""
    hurrying: bool = False
    """Whether the replay is playing to a position as fast as possible."""


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


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Campaign, link, replay, and the manoeuvre that the engineer has selected."""

    state: CampaignState
    health: LinkHealth
    playback: Playback | None
    """Position of a replay. None on a live link, and before the log is read."""
    aircraft: Aircraft
    title: str
    """Name of the source: of the log or the link."""
    tempo: Tempo | None = None
    """Tempo of a replay: its speed, and whether it is paused. None on a live link."""
    log: tuple[str, ...] = ()
    """Sentences of the event log, oldest first."""
    problems: tuple[Problem, ...] = ()
    """Reasons for which the complete stream cannot be judged, until the first manoeuvre is judged."""
    selected: int | None = None
    """Number of the manoeuvre selected by hand; None: always the newest."""
    logs: tuple[Path, ...] = ()
    """Logs and recordings, by flight, next to which files are written. Empty: the current folder."""
    aircraft_file: Path | None = None
    """Path of the aircraft file, for commands that the user types afterwards; None without a file."""
    elevator: "View | None" = None
    """View of the elevator's axis, if this view shows roll and yaw. None: this view shows the elevator's
    axis."""

    @property
    def obstacles(self) -> tuple[Problem, ...]:
        """Reasons for which nothing can be judged: from the present data, and at the end from the complete
        stream."""
        problems = self.problems if self.health.condition == "ended" else self.state.no_data
        wrong = (f.problem for f in self.state.instruments if f.refuses)
        return tuple({p.code: p for p in (*problems, *wrong)}.values())

    @property
    def plan(self) -> CrewPlan | None:
        """Plan of both axes, whichever axis is shown; None if only one axis has been flown."""
        return (self.elevator or self).state.plan

    @property
    def judged(self) -> JudgedManeuver | None:
        """Manoeuvre that is shown in detail. None before the first manoeuvre."""
        maneuvers = self.state.maneuvers
        newest = maneuvers[-1] if maneuvers else None
        return next((j for j in maneuvers if j.maneuver.number == self.selected), newest)

    @property
    def last(self) -> JudgedManeuver | None:
        """Newest manoeuvre that is not excluded by hand."""
        return next((j for j in reversed(self.state.maneuvers) if j.excluded_because is None), None)


def view_before_first(
    aircraft: Aircraft,
    title: str,
    tempo: Tempo | None,
    logs: tuple[Path, ...] = (),
    aircraft_file: Path | None = None,
) -> View:
    """Return the view before the first report."""
    first = report_before_first(aircraft, title)
    return View(
        first.state, first.health, None, aircraft, title, tempo, logs=logs, aircraft_file=aircraft_file
    )


def report_before_first(aircraft: Aircraft, title: str) -> SessionReport:
    """Return an empty report, without manoeuvres and messages, for the time before the first report."""
    plan = aircraft.campaign
    limit = limit_percent(plan.rule, plan)
    verdict = FlightTestVerdict(plan.rule, "continue", "No manoeuvre has been flown yet.", None, limit, None)
    pitch = AxisState[Estimate]((), verdict, None)
    state = CampaignState(vehicle=None, now_s=nan, mode="", channels={}, axes={AXES[0]: pitch})
    return SessionReport(state, LinkHealth("waiting", f"Opening {title}."), None, ())


def view_sideways(view: View) -> View:
    """Return the view of roll and yaw. If roll and yaw are not judged, return the given view.

    Only a manoeuvre of the elevator is followed while it is being flown.
    """
    if view.state.lateral is None:
        return view
    others = tuple(problem for problem in view.state.no_data if problem.code not in OF_ELEVATOR)
    state = replace(view.state, shown="lateral", flying=None, no_data=others)
    problems = tuple(problem for problem in view.problems if problem.code not in OF_ELEVATOR)
    return replace(view, state=state, problems=problems, elevator=view)
