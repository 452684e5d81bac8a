"""One moment as the panes see it."""

from dataclasses import dataclass
from math import nan
from pathlib import Path

from advisor.aircraft import Aircraft
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.decision.verdict import FlightTestVerdict, limit_percent
from advisor.problems import Problem
from advisor.tui.source import LinkHealth, Playback, Tempo


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """The campaign, the link, the replay, and which manoeuvre an engineer looks at."""

    state: CampaignState
    health: LinkHealth
    playback: Playback | None
    """Where a replay stands; None on a live link, and before the log is read."""
    aircraft: Aircraft
    title: str
    """What the source is called."""
    tempo: Tempo | None = None
    """How a replay is wanted to run; None on a live link."""
    log: tuple[str, ...] = ()
    """What happened so far, oldest first."""
    problems: tuple[Problem, ...] = ()
    """Why nothing can be judged of the whole stream, while nothing has been."""
    selected: int | None = None
    """Number of the manoeuvre chosen by hand; None: always the newest."""
    logs: tuple[Path, ...] = ()
    """Logs and recordings, flight by flight. Panes are saved into their folders, else the current one."""

    @property
    def obstacles(self) -> tuple[Problem, ...]:
        """Why nothing can be judged: of what arrives at present; at the end, of the whole stream."""
        return self.problems if self.health.condition == "ended" else self.state.no_data

    @property
    def judged(self) -> JudgedManeuver | None:
        """The manoeuvre to show in detail; None before the first."""
        maneuvers = self.state.maneuvers
        newest = maneuvers[-1] if maneuvers else None
        return next((j for j in maneuvers if j.maneuver.number == self.selected), newest)

    @property
    def last(self) -> JudgedManeuver | None:
        """The newest manoeuvre that nobody took out by hand."""
        return next((j for j in reversed(self.state.maneuvers) if j.excluded_because is None), None)


def view_before_first(
    aircraft: Aircraft, title: str, tempo: Tempo | None, logs: tuple[Path, ...] = ()
) -> View:
    """What there is to show before the first report: nothing flown, nothing heard."""
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
    return View(state, LinkHealth("waiting", f"Opening {title}."), None, aircraft, title, tempo, logs=logs)
