"""Analysis as text for people. Stop or continue comes first, angles are in degrees, and each verdict has a
sentence.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import Any

from rich import table as console
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.campaign.campaign import Campaign, CampaignEvent, ManeuverJudged
from advisor.campaign.single_maneuver import InputEnough
from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.decision.verdict import CrewPlan, FlightTestVerdict
from advisor.flight.maneuvers.maneuver import (
    Activity,
    DataAgain,
    FlightBegan,
    ManeuverAgain,
    NoData,
    Notice,
    Rebooted,
    VehicleFound,
)
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.trust import InstrumentFinding
from advisor.oem.estimate import Estimate
from advisor.report.facts.answers import INDENT, WARNING, decisions, next_line, stop_line
from advisor.report.facts.estimates import EstimatedParameter, of_all, structure_lines, untold
from advisor.report.qualities import (
    coefficients_of,
    qualities_of,
    quality_lines,
    reference_speed,
    side_quality_lines,
)
from advisor.words.problems import plain
from advisor.words.quantities import CLOCK, NORMAL_95, clock, counted, signed, symbol, with_half


@dataclass(frozen=True, slots=True)
class Table:
    """Table of text cells. The first row names the columns."""

    name: str
    """Anchor of the table within the page."""
    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: frozenset[int] = frozenset()
    """Indices of the columns with numbers, from 0."""
    anchored: bool = False
    """Whether each row has an anchor in the page. The anchor is the table's name, a hyphen and the row's
    first cell.
    """

    def on_console(self, title: str | None = None) -> console.Table:
        """Return the table for a terminal, without frame, under a title."""
        shown = console.Table(
            title=title,
            title_justify="left",
            title_style="bold",
            box=None,
            pad_edge=False,
            header_style="dim",
        )
        for k, name in enumerate(self.head):
            shown.add_column(name, justify="right" if k in self.numbers else "left", no_wrap=k == 0)
        for row in self.rows:
            shown.add_row(*row)
        return shown


def digits(value: float | None, count: int) -> str:
    """Return a number with ``count`` decimals; a dash for a missing or undefined one."""
    return "–" if value is None or value != value else f"{value:.{count}f}"


class PlainConsole(Console):
    """Console on standard output that shows text literally, because names may contain brackets.

    Without Unicode, cells become ASCII before their widths are measured, so that columns stay aligned.

    Parameters
    ----------
    soft_wrap
        Whether the terminal wraps long lines.
    """

    def __init__(self, soft_wrap: bool = False) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, soft_wrap=soft_wrap)

    def render_str(self, text: str, **options: Any) -> Text:
        """Return the text of a cell or line given as a string."""
        return super().render_str(plain(text) if self.options.ascii_only else text, **options)


ROOM, SIDE_ROOM = 15, 18
"""Width of the name of an input of the elevator, and of aileron or rudder, in columns."""


def maneuver_line(judged: JudgedManeuver, room: int = ROOM) -> str:
    """Return one line for a verdict: number, time, input in ``room`` columns, verdict and reason."""
    span, verdict = judged.maneuver.span, judged.verdict
    at, mark = clock(span.start_s), "✓" if verdict.accepted else "✗"
    return f"{judged.maneuver.number:2d}  {at:>7}  {span.kind:<{room}}  {mark} {verdict.sentence}"


def joint_table(
    state: CampaignState | LateralState, prior: Mapping[str, float], name: str = "joint"
) -> Table | None:
    """Return the table of an axis's joint estimate next to the simulator's model; None without an accepted
    manoeuvre.

    ``name`` names the table and is unique on a page.
    """
    if state.model is None:
        return None
    if isinstance(state, CampaignState):
        return joint_of(name, reference_speed(state), [of_all(p, state, prior) for p in PARAMETERS])
    rows = [of_all(p, state, prior) for p in SIDE_PARAMETERS]
    return joint_of(name, reference_speed(state), rows, " L and N include the products of inertia.")


def joint_of(name: str, at: str, rows: Sequence[EstimatedParameter], more: str = "") -> Table:
    """Return the table ``name`` of a joint estimate, with the air speed as text.

    The simulator has no column if the aircraft file has no model. ``more`` follows the sentence above the
    table.
    """
    compared = any(row.prior is not None for row in rows)
    head = ("parameter", "estimate ± 95 %", "± 95 % if white", *(["simulator"] if compared else []), "unit")
    cells = tuple(
        (
            row.name,
            row.cell,
            "–" if row.reason or row.held else f"{row.half_if_white:.2g}",
            *([row.prior_cell] if compared else []),
            row.unit,
        )
        for row in rows
    )
    caption = f"{rows[0].source}{at}; ± is half the 95 % interval.{more}"
    return Table(name, caption, head, cells, frozenset({1, 2, 3} if compared else {1, 2}))


def structure_table(estimate: Estimate, name: str) -> Iterator[Table]:
    """Yield the table of the parameters that the user holds and of the terms that the user adds, if any."""
    rows = [(symbol(p), f"{signed(estimate.value(p), 3)}, held", "–", "SI") for p in estimate.fixed]
    rows += [
        (term.name, with_half(term.value, NORMAL_95 * term.std), digits(term.gained, 1), "SI")
        for term in estimate.terms
    ]
    if rows:
        yield Table(
            name, "Parameters that are held, and terms that are added to the equations.",
            ("parameter or term", "value ± 95 %", "log likelihood gained", "unit"),
            tuple(rows), frozenset({1, 2}),
        )  # fmt: skip


def channel_table(name: str, caption: str, channels: Mapping[str, ChannelStatus]) -> Table:
    """Return the table of the channels of a log: source, provenance, rate and largest gap."""
    return Table(
        name, caption, ("channel", "source", "provenance", "rate [Hz]", "largest gap [s]"),
        tuple(
            (channel, c.source, c.provenance, digits(c.rate_hz, 1), digits(c.largest_gap_s, 2))
            for channel, c in channels.items()
        ),
        frozenset({3, 4}),
    )  # fmt: skip


def message_table(name: str, messages: Sequence[Mapping[str, Any]]) -> Table:
    """Return the table of the messages of ``advisor.doctor/1``: rates, jitter and largest gap."""
    decimals = {"rate_hz": 1, "lowest_hz": 1, "renewed_hz": 1, "jitter_ms": 1, "largest_gap_s": 3}
    head = ("message", "rate [Hz]", "lowest [Hz]", "new [Hz]", "jitter [ms]", "gap [s]")
    rows = tuple((m["name"], *(digits(m[k], n) for k, n in decimals.items())) for m in messages)
    return Table(name, "Rates of the messages; gap: the largest.", head, rows, frozenset(range(1, 6)))


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


def follow(
    batches: Iterator[Sequence[Columns]],
    campaign: Campaign,
    say: Callable[[str], object],
    of_log: bool = False,
) -> CampaignState:
    """Feed a campaign to the end of a stream and print every verdict.

    A log often begins with slow streams, which the crew corrects before the flight. An alarm about a log is
    therefore printed only after the log's data have been usable once.

    Parameters
    ----------
    batches
        Messages in order of arrival. Empty batches represent pauses.
    of_log
        Whether the stream is a log, in which nothing can be corrected.
    """
    begun = not of_log
    for columns in batches:
        for event in campaign.feed(columns):
            if begun or not isinstance(event, NoData | DataAgain):
                _say(event, say)
        begun = begun or campaign.serves
    for event in campaign.finish():
        _say(event, say)
    state = campaign.state
    side = state.lateral
    if side is not None and not side.maneuvers and side.flight_test.next is None:
        say(f"note: {side.flight_test.sentence}")
    for part in state.failed:
        say(part.sentence)
    return state


def _say(event: CampaignEvent, say: Callable[[str], object]) -> None:
    match event:
        case FlightBegan(_, name):
            say(f"{name}: times of this log count from its own power-on")
        case ManeuverAgain(maneuver, takes_place):
            better = ", with this better record" if takes_place else ""
            at = clock(maneuver.span.start_s)
            say(f"{maneuver.number:2d}  {at:>7}  is already recorded and counts once{better}")
        case InputEnough(number):
            say(f"ENOUGH: each derivative is within its tolerance in input {number} of the script")
        case VehicleFound(vehicle):
            say(f"following {vehicle}; times are {CLOCK}")
        case Rebooted(boot):
            say(f"power-on {boot + 1}: the vehicle's clock began anew, and times count from this power-on")
        case Notice(_, text):
            say(f"note: {text}")
        case NoData(problems):
            for problem in problems:
                say(f"NO DATA: {problem}")
        case DataAgain():
            say("DATA AGAIN: what arrives can serve.")
        case ManeuverJudged(judged, verdict, plan, axis, revised):
            side = axis == "lateral"
            say(f"{maneuver_line(judged, SIDE_ROOM)}  (roll and yaw)" if side else maneuver_line(judged))
            for said in revised:
                say(f"    CHANGED: {said}")
            _say_decision(verdict, plan, say)


def _say_decision(verdict: FlightTestVerdict, plan: CrewPlan | None, say: Callable[[str], object]) -> None:
    """Print stop or continue and the next input. After one axis is complete, print both axes."""
    if plan is not None and plan.done:
        say(f"    {plan.announced}")
        say(f"    {plan.advice}")
    else:
        say(f"    {stop_line(verdict)}")
        say(f"    {next_line(verdict)}")
