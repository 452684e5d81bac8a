"""State of one moment for the panes."""

from dataclasses import dataclass
from math import nan
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.decision.verdict import FlightTestVerdict, limit_percent
from advisor.session.source import LinkHealth, Playback, Tempo
from advisor.words.problems import Problem


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Campaign, link, replay, and the manoeuvre that an engineer looks at."""

    state: CampaignState
    health: LinkHealth
    playback: Playback | None
    """Position of a replay. None on a live link, and before the log is read."""
    aircraft: Aircraft
    title: str
    """Name of the source."""
    tempo: Tempo | None = None
    """Tempo of a replay. None on a live link."""
    log: tuple[str, ...] = ()
    """Sentences of the event log, oldest first."""
    problems: tuple[Problem, ...] = ()
    """Reasons for which nothing can be judged of the whole stream, while nothing has been judged."""
    selected: int | None = None
    """Number of the manoeuvre chosen by hand; None: always the newest."""
    logs: tuple[Path, ...] = ()
    """Logs and recordings, flight by flight, next to which files are written. Empty: the current folder."""
    aircraft_file: Path | None = None
    """Aircraft file, for commands to type afterwards; None without one."""
    elevator: "View | None" = None
    """View of the elevator's axis, where this one shows roll and yaw. None: this one shows the elevator's."""

    @property
    def obstacles(self) -> tuple[Problem, ...]:
        """Reasons for which nothing can be judged: of the present data, and at the end of the whole
        stream."""
        found = self.problems if self.health.condition == "ended" else self.state.no_data
        wrong = (f.problem for f in self.state.instruments if f.refuses)
        return tuple({p.code: p for p in (*found, *wrong)}.values())

    @property
    def judged(self) -> JudgedManeuver | None:
        """Manoeuvre that is shown in detail. None before the first."""
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
    """Return the view before the first report: nothing flown, nothing heard."""
    plan = aircraft.campaign
    limit = limit_percent(plan.rule, plan)
    verdict = FlightTestVerdict(plan.rule, "continue", "No manoeuvre has been flown yet.", None, limit, None)
    state = CampaignState(
        vehicle=None,
        now_s=nan,
        duration_s=0.0,
        mode="",
        channels={},
        maneuvers=(),
        flight_test=verdict,
        model=None,
    )
    waiting = LinkHealth("waiting", f"Opening {title}.")
    return View(state, waiting, None, aircraft, title, tempo, logs=logs, aircraft_file=aircraft_file)
