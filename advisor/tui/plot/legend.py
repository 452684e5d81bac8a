"""The first line of a plot: quantity, unit, and what each mark means without its colour."""

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from advisor.tui.plot.chart import INKS, Chart

_SAMPLE = {"line": "──", "points": "∙∙"}


def legend(chart: Chart, width: int, style: Style, inks: list[Style]) -> Strip:
    """Compose the line; what does not fit is left away from the right."""
    curves = [(f"  {_SAMPLE[s.mark]} {s.name}", s.ink) for s in chart.series if s.name]
    levels = [(f"  ╌╌ {level.name}", level.ink) for level in chart.levels]
    parts = [(chart.y_label, style), *((text, inks[INKS.index(ink)]) for text, ink in (*curves, *levels))]
    segments, used = [], 0
    for text, ink in parts:
        if used + len(text) > width:
            break
        segments.append(Segment(text, ink))
        used += len(text)
    return Strip([*segments, Segment(" " * (width - used), style)], width)
