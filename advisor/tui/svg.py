"""SVG pictures of a terminal that look equal on every machine."""

import io
import re
from collections.abc import Iterator, Sequence
from html import escape, unescape

from rich.console import Console
from rich.segment import Segment
from textual.strip import Strip

from advisor.tui.plot.canvas import BITS, BLANK

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
