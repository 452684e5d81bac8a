"""State of one moment for the panes, of the elevator's axis or of roll and yaw."""

from dataclasses import dataclass, replace
from math import nan
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import OF_ELEVATOR, AxisState, CampaignState, JudgedManeuver
from advisor.decision.crew_plan import CrewPlan
from advisor.decision.verdict import FlightTestVerdict, limit_percent
from advisor.oem.estimate import Estimate
from advisor.session.conducting import SessionReport
from advisor.session.source import LinkHealth, Playback, Tempo
from advisor.words.axes import AXES
from advisor.words.problems import Problem


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
