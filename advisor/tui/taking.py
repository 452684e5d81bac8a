"""A pane as text for the clipboard, and as files in the log's folder."""

import io
import re
from collections.abc import Iterator, Sequence
from html import escape, unescape
from pathlib import Path

from rich.console import Console
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region
from textual.strip import Strip

from advisor.process.atomic_file import write_atomically
from advisor.session.conducting import View
from advisor.tui.panes.pane import Pane
from advisor.tui.plot.painting import BITS, BLANK, Plot
from advisor.words.problems import printable

_CELL_WIDTH, _CELL_HEIGHT, _BASELINE = 12.2, 24.4, 18.5
_TEXT = re.compile(
    r'<text class="(?P<ink>[^"]*)" x="(?P<x>[^"]*)" y="(?P<y>[^"]*)" textLength="[^"]*"(?P<rest>[^>]*)>'
    r"(?P<text>[^<]*)</text>"
)
_FONTS = re.compile(r"@font-face \{.*?\}", re.DOTALL)
_RUNS = re.compile(
    r"(?P<blocks>█+)|(?P<dots>[\u2801-\u28ff]+)|[^█\u2801-\u28ff\xa0]+(?:\xa0[^█\u2801-\u28ff\xa0]+)*"
)


def drawn(svg: str) -> str:
    """Draw dots and blocks as shapes and remove fonts, so that the picture is equal on every machine."""
    return _TEXT.sub(_shapes, _FONTS.sub("", svg))


def _shapes(line: re.Match[str]) -> str:
    """Return a piece of a terminal line as SVG, with words as text and blocks and dots as shapes."""
    drawn_runs = []
    for run in _RUNS.finditer(unescape(line["text"])):
        x, width = float(line["x"]) + run.start() * _CELL_WIDTH, len(run[0]) * _CELL_WIDTH
        top = float(line["y"]) - _BASELINE
        if run["blocks"]:
            # A little higher than a cell, lest the background shine through between rows.
            size = f'width="{width:.1f}" height="{_CELL_HEIGHT + 0.6:.1f}"'
            drawn_runs.append(f'<rect x="{x:.1f}" y="{top:.1f}" {size}/>')
        elif run["dots"]:
            drawn_runs += [
                dot for k, cell in enumerate(run[0]) for dot in _dots(x + k * _CELL_WIDTH, top, cell)
            ]
        else:
            place = f'x="{x:.1f}" y="{line["y"]}" textLength="{width:.1f}"'
            drawn_runs.append(f"<text {place}{line['rest']}>{escape(run[0])}</text>")
    return f'<g class="{line["ink"]}">{"".join(drawn_runs)}</g>'


def _dots(x: float, top: float, cell: str) -> list[str]:
    bits = ord(cell) - BLANK
    return [
        f'<circle cx="{x + (0.25 + 0.5 * column) * _CELL_WIDTH:.1f}" '
        f'cy="{top + (0.125 + 0.25 * row) * _CELL_HEIGHT:.1f}" r="1.8"/>'
        for row in range(4)
        for column in range(2)
        if bits & int(BITS[row, column])
    ]


def picture_of(strips: Sequence[Strip], width: int, title: str) -> str:
    """Draw lines of a terminal as SVG."""
    console = Console(
        width=width,
        height=len(strips),
        file=io.StringIO(),
        force_terminal=True,
        color_system="truecolor",
        record=True,
        legacy_windows=False,
    )
    console.print(_Lines(strips), end="")
    return drawn(console.export_svg(title=title))


class _Lines:
    """Lines of a terminal that Rich can print."""

    def __init__(self, strips: Sequence[Strip]) -> None:
        self._strips = strips

    def __rich_console__(self, console: Console, options: object) -> Iterator[Segment]:
        for strip in self._strips:
            yield from strip
            yield Segment.line()


WITHOUT_LOG = Path("advisor")
"""Name of the files if no log is recorded. These files are written into the current folder."""


def pane_name(pane: Pane, view: View) -> str:
    """Return the file name of a pane: ``fit-4`` for the fit of manoeuvre 4, ``history`` without a number."""
    name = "-".join(pane.TITLE.split()[1:]).lower()
    judged = view.judged if pane.OF_SELECTED else None
    return f"{name}-{judged.maneuver.number}" if judged is not None else name


def log_of(pane: Pane, view: View) -> Path:
    """Return the log whose name the files get: the log of the selected manoeuvre, else the newest log.

    In a browser only the title names the log of a replay.
    """
    if not view.logs:
        return Path(Path(view.title.split(", ")[0]).name) if view.tempo is not None else WITHOUT_LOG
    judged = view.judged if pane.OF_SELECTED else None
    flight = judged.maneuver.flight if judged is not None else view.state.flight
    return view.logs[min(flight, len(view.logs) - 1)]


def files_of(pane: Pane, view: View) -> dict[str, str]:
    """Return the files of a pane by name: CSV of its rows or its text, and SVG of its plots."""
    log, name = log_of(pane, view), pane_name(pane, view)
    stem = f"{log.stem}.{name}"
    files = {f"{stem}.csv" if pane.rows() is not None else f"{stem}.txt": pane.text()}
    if picture := picture_of_plots(pane, f"{log.name}  {pane.TITLE}  {pane.border_subtitle or ''}".strip()):
        files[f"{stem}.svg"] = picture
    return files


def save(pane: Pane, view: View) -> str:
    """Write the files of a pane into the folder of the log, and return a sentence on the place or the
    failure.

    A file from an earlier save is replaced. A file gets its final name only after it is complete.
    """
    folder, files = log_of(pane, view).parent, files_of(pane, view)
    names = " and ".join(map(printable, files))
    try:
        for file, text in files.items():
            write_atomically(folder / file, text)
    except OSError as error:
        place = printable(str(folder))
        return f"{names} cannot be written in {place}: {error.strerror or error}; key c copies instead"
    return f"saved {names} in {printable(str(folder.absolute()))}"


def picture_of_plots(pane: Pane, title: str) -> str:
    """Draw the visible plots of the pane as one SVG; empty if no plot has curves."""
    plots = [plot for plot in pane.query(Plot) if plot.display and plot.chart.series and plot.size.area]
    if not plots:
        return ""
    around = Region.from_union([plot.region for plot in plots])
    strips = []
    for y in range(around.y, around.bottom):
        across = sorted((p for p in plots if p.region.y <= y < p.region.bottom), key=lambda p: p.region.x)
        strips.append(_joined(across, y, around, plots[0].rich_style))
    return picture_of(strips, around.width, title)


def _joined(plots: list[Plot], y: int, around: Region, paper: Style) -> Strip:
    """Join one line of several plots that stand side by side."""
    pieces, x = [], around.x
    for plot in plots:
        pieces += [Strip.blank(plot.region.x - x, paper), plot.render_line(y - plot.region.y)]
        x = plot.region.right
    return Strip.join([*pieces, Strip.blank(around.right - x, paper)])
