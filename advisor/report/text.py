"""Analysis as text for people. Stop or continue comes first, angles are in degrees, and each verdict has a
sentence.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, groupby

from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.maneuvers.events import Activity
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.report.axes.lateral_document import side_quality_lines
from advisor.report.facts.answers import INDENT, WARNING, decisions
from advisor.report.facts.estimates import structure_lines, untold
from advisor.report.qualities import coefficients_of, qualities_of, quality_lines
from advisor.report.table import (
    ROOM,
    SIDE_ROOM,
    channel_table,
    joint_table,
    maneuver_line,
)
from advisor.words.digits import CLOCK, clock, counted


def activity_line(activity: Activity) -> str:
    """Return one line, with time and description, for a movement of the elevator that was no test input."""
    return f" -  {clock(activity.start_s):>7}  to {clock(activity.end_s):<12}  {activity.text}"


def instrument_lines(findings: Iterable[InstrumentFinding]) -> list[str]:
    """Return one line for each instrument contradiction, with its remedy."""
    return [f"{'!' if f.used else '✗'} {f.sentence}. -> {f.fix}." for f in findings if f.contradicts]


def caution_lines(maneuvers: Sequence[JudgedManeuver]) -> list[str]:
    """Return each caution once, with the numbers of its manoeuvres."""
    numbers: dict[str, list[int]] = {}
    for judged in maneuvers:
        for caution in judged.verdict.cautions:
            numbers.setdefault(caution, []).append(judged.maneuver.number)
    return [f"[{counted(on)}] {caution}" for caution, on in numbers.items()]


def _apart(lines: Iterable[Text]) -> Iterator[Text]:
    """Yield an empty line before lines; nothing without lines."""
    for number, line in enumerate(lines):
        if number == 0:
            yield Text()
        yield line


class AnalysisText:
    """Text of the whole analysis, at the width of the terminal. Colour is left out if the user does not want
    any.
    """

    def __init__(
        self,
        state: CampaignState,
        files: Sequence[str],
        aircraft: Aircraft,
        every_movement: bool = False,
        pitch: bool = True,
    ) -> None:
        self.state, self.files, self.aircraft = state, files, aircraft
        self.every_movement, self.pitch = every_movement, pitch

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the decisions on both axes, then the results on which the decisions rest."""
        for line in decisions(self.state, pitch=self.pitch):
            plain = "yellow" if line.startswith(WARNING) else ""
            yield Text(line, style=plain if line.startswith(INDENT) else "bold")
        yield Text()
        for flight in self.state.flights:
            vehicle = flight.vehicle if flight.vehicle else "no vehicle"
            yield Text(f"{self.files[flight.flight]}: {vehicle}", style="bold")
            yield channel_table("channels", "", flight.channels).on_console()
            if flight.again:
                yield Text(f"note: {flight.again} of its manoeuvres are in an earlier log: they count once.")
        yield from (
            Text(f"note: {note}", style="yellow")
            for note in (*self.state.elevator_notes, *self.state.reader_notes, *self.state.mark_notes)
        )
        yield from (Text(line, style="yellow") for line in instrument_lines(self.state.instruments))
        # Movements of the elevator in a flight that tests another axis are no manoeuvres.
        if self.pitch and (self.every_movement or self.state.tested_sideways is None):
            flown = self._movements(self.state.maneuvers, self.state.activity)
            yield from self._axis(self.state, flown, self._qualities())
        elif self.pitch and (left := len(self.state.maneuvers)):
            several = "s" if left > 1 else ""
            yield Text(f"--all lists {left} refused movement{several} of the elevator", style="dim")
        if (side := self.state.lateral) is not None and side.maneuvers:
            flown = self._movements(side.maneuvers, (), SIDE_ROOM)
            lines = chain([Text("Roll and yaw", style="bold")], flown)
            yield from self._axis(side, lines, map(Text, side_quality_lines(side, self.aircraft)))

    def _axis(
        self, axis: CampaignState | LateralState, movements: Iterable[Text], qualities: Iterable[Text]
    ) -> RenderResult:
        """Yield manoeuvres, parameters and rules of one axis."""
        yield from _apart(movements)
        yield from _apart(Text(line, style="dim") for line in caution_lines(axis.maneuvers))
        joint = joint_table(axis, self.aircraft.model)
        if axis.model is not None and joint is not None:
            yield Text()
            yield joint.on_console(joint.caption)
            yield from map(Text, (*structure_lines(axis.model), *untold(axis.model)))
            said = {caution for judged in axis.maneuvers for caution in judged.verdict.cautions}
            yield from (Text(f"note: {note}") for note in axis.model.notes if note not in said)
            yield from _apart(qualities)
        yield from _apart(self._rules(axis.flight_test) if axis.maneuvers else ())

    def _movements(
        self, maneuvers: Sequence[JudgedManeuver], activity: Sequence[Activity], room: int = ROOM
    ) -> Iterator[Text]:
        """Yield the manoeuvres and, on request, all other movements, in order of time."""
        lines = []
        for judged in maneuvers:
            maneuver = judged.maneuver
            at = (maneuver.flight, maneuver.boot, maneuver.span.start_s)
            style = "green" if judged.verdict.accepted else "red"
            lines.append((at, Text(maneuver_line(judged, room), style=style)))
            lines += [(at, Text(f"    note: {note}")) for note in judged.notes]
        if self.every_movement:
            lines += [((a.flight, a.boot, a.start_s), Text(activity_line(a), style="dim")) for a in activity]
        in_order = sorted(lines, key=lambda entry: entry[0])
        if in_order:
            yield Text(_TIMES, style="dim")
        for flight, here in groupby(in_order, key=lambda entry: entry[0][0]):
            if len(self.files) > 1:
                yield Text(f"{self.files[flight]}:", style="bold")
            yield from (line for _, line in here)

    def _qualities(self) -> Iterator[Text]:
        reference = self.aircraft.reference
        qualities = qualities_of(self.state, reference)
        if qualities is not None:
            lines = quality_lines(qualities, coefficients_of(self.state, reference))
            yield from (Text(line, style="bold" if line[0] in "FC" else "") for line in lines)

    def _rules(self, verdict: FlightTestVerdict) -> Iterator[Text]:
        is_short = not self.every_movement and verdict.rule == "information"
        others = [rule for rule in _PAPERS if rule in verdict.by_rule] if is_short else []
        for name, progress in verdict.by_rule.items():
            if name in others:
                continue
            history = " ".join("–" if v is None else f"{v:.1f}" for v in progress.history_percent)
            stopped = "not yet" if progress.stopped_at is None else f"after manoeuvre {progress.stopped_at}"
            yield Text(f"rule {name:<12} stop: {stopped:<20} criterion %: {history}")
            if progress.hindsight:
                yield Text(f"{'':<18}{progress.hindsight}", style="dim")
        if others:
            yield Text(_papers_rules(verdict), style="dim")
        yield from (Text(f"information: {line}", style="dim") for line in verdict.evidence)


_TIMES = f"no.  start  times are {CLOCK}"
"""Head of a list of manoeuvres."""
_PAPERS: tuple[Rule, ...] = ("continuous", "separate")
"""Rules of the paper."""


def _papers_rules(verdict: FlightTestVerdict) -> str:
    """Return one line on the paper's rules, which decide only if the crew chooses one of them."""
    said = []
    for name in _PAPERS:
        progress = verdict.by_rule[name]
        now = "too few manoeuvres" if progress.now_percent is None else f"{progress.now_percent:.0f} %"
        stop = "" if progress.stopped_at is None else f", stop after manoeuvre {progress.stopped_at}"
        said.append(f"{name} {now}{stop}")
    limit = f"limit {verdict.by_rule[_PAPERS[0]].limit_percent:g} %"
    return f"the paper's rules: {'; '.join(said)} ({limit}); --all prints their history"
