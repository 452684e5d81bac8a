"""Tables and rows of results as text cells, for terminal and page, and the console that prints them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich import table as console
from rich.console import Console
from rich.text import Text

from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.flight.signals.track import ChannelStatus
from advisor.oem.estimate import Estimate
from advisor.report.facts.estimates import EstimatedParameter, of_all
from advisor.report.qualities import reference_speed
from advisor.words.ascii_output import plain
from advisor.words.digits import clock, signed, with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol


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
