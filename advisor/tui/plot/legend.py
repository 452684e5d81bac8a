"""The first line of a plot: quantity, unit, and the meaning of each mark without its colour."""

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from advisor.tui.plot.chart import INKS, Chart

_SAMPLE = {"line": "──", "joined": "──", "points": "∙∙", "stems": "││", "intervals": "├┤"}


def legend(chart: Chart, read: list[str], width: int, style: Style, inks: list[Style]) -> Strip:
    """Compose the line, from left to right as far as there is room.

    Parameters
    ----------
    chart
        Chart with the names.
    read
        One text for each series: its value at the cursor, empty without one.
    width
        Cells of the line.
    style, inks
        Style of words, and of each ink.
    """
    curves = [
        (f"  {_SAMPLE[s.mark]} {s.name} {value}".rstrip(), s.ink)
        for s, value in zip(chart.series, read, strict=True)
        if s.name
    ]
    levels = [
        (f"  {'╌╌' if level.dashed else '──'} {level.name}", level.ink)
        for level in chart.levels
        if level.name
    ]
    parts = [(chart.y_label, style), *((text, inks[INKS.index(ink)]) for text, ink in (*curves, *levels))]
    segments, used = [], 0
    for text, ink in parts:
        if used + len(text) > width:
            break
        segments.append(Segment(text, ink))
        used += len(text)
    return Strip([*segments, Segment(" " * (width - used), style)], width)
