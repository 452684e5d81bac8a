"""The plot widget: a chart painted on a braille canvas with axes."""

from itertools import pairwise
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip
from textual.widget import Widget

from advisor.flight.messages import FloatArray
from advisor.tui.plot.axis import Axis, LogAxis, log_axis, round_axis
from advisor.tui.plot.canvas import Canvas
from advisor.tui.plot.chart import INKS, Chart, Ink
from advisor.tui.plot.labels import along_the_foot, down_the_side, whole
from advisor.tui.plot.legend import legend

_ROWS_PER_TICK = 3
_ROWS_PER_LOG_TICK = 2
_COLUMNS_PER_TICK = 12
_BOLD: frozenset[Ink] = frozenset({"fitted", "limit"})


class Plot(Widget):
    """Paints a `Chart`; repaints only when the chart, the size or the theme changes."""

    def __init__(self, chart: Chart, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self._chart = chart
        self._strips: list[Strip] | None = None

    @property
    def chart(self) -> Chart:
        """What is shown."""
        return self._chart

    @chart.setter
    def chart(self, chart: Chart) -> None:
        if chart is not self._chart:
            self._chart = chart
            self._strips = None
            self.refresh()

    def on_resize(self) -> None:
        """A new size needs new ticks."""
        self._strips = None

    def notify_style_update(self) -> None:
        """A new theme needs new colours."""
        super().notify_style_update()
        self._strips = None

    def render_line(self, y: int) -> Strip:
        """One line of the painted chart."""
        if self._strips is None:
            self._strips = self._paint(self.size.width, self.size.height)
        return self._strips[y] if y < len(self._strips) else Strip.blank(self.size.width, self.rich_style)

    def _inks(self, base: Style) -> list[Style]:
        """The theme's colours; as component classes they would be looked up anew at every change of focus."""
        colours = self.app.theme_variables
        return [base + Style(color=colours[f"ink-{ink}"], bold=ink in _BOLD) for ink in INKS]

    def _paint(self, width: int, height: int) -> list[Strip]:
        chart, base = self._chart, self.rich_style
        if not chart.series:
            return _sentence(f"{chart.y_label}: {chart.why_empty}", width, base)
        if width < 16 or height < 4:
            return _sentence(f"{chart.y_label}: too little room for a plot.", width, base)
        inks = self._inks(base)
        rows = height - 2
        y_axis = _y_axis(chart, rows)
        gutter = max(len(label) for label in y_axis.labels) + 1
        columns = max(2, width - gutter)
        x_axis = round_axis([s.x for s in chart.series], max(1, columns // _COLUMNS_PER_TICK))
        if chart.whole_x:
            x_axis = whole(x_axis)
        canvas = Canvas(columns, rows, (x_axis.low, x_axis.high), (y_axis.low, y_axis.high))
        for level in chart.levels:
            canvas.level(float(_scaled(chart, np.array([level.y]))[0]), INKS.index(level.ink))
        for series in chart.series:
            draw = canvas.line if series.mark == "line" else canvas.points
            draw(series.x, _scaled(chart, series.y), INKS.index(series.ink))
        side = down_the_side(y_axis, rows, gutter)
        foot = along_the_foot(x_axis, chart.x_label, gutter, width)
        return [
            legend(chart, width, base, inks),
            *(
                Strip([Segment(side[row], base), *_runs(text, canvas.ink[row], inks, base)], width)
                for row, text in enumerate(canvas.text())
            ),
            Strip([Segment(foot, base)], width),
        ]


def _y_axis(chart: Chart, rows: int) -> Axis | LogAxis:
    heights = [s.y for s in chart.series] + [np.array([level.y]) for level in chart.levels]
    if chart.log_y:
        return log_axis(heights, max(2, rows // _ROWS_PER_LOG_TICK))
    return round_axis(heights, max(1, rows // _ROWS_PER_TICK))


def _scaled(chart: Chart, y: FloatArray) -> FloatArray:
    """Heights as the axis counts them."""
    if not chart.log_y:
        return y
    return np.log10(np.where(y > 0.0, y, np.nan))


def _runs(text: str, ink: NDArray[np.int8], inks: list[Style], base: Style) -> list[Segment]:
    """One segment for each stretch of cells in one colour."""
    edges = [0, *(np.flatnonzero(np.diff(ink)) + 1).tolist(), len(text)]
    styles = [*inks, base]
    return [Segment(text[i:j], styles[ink[i]]) for i, j in pairwise(edges)]


def _sentence(text: str, width: int, style: Style) -> list[Strip]:
    return [Strip([Segment(line.ljust(width), style)], width) for line in wrap(text, max(width, 1))]
