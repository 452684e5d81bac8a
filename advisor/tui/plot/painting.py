"""A chart painted as the lines of a terminal, on a canvas of braille dots, and the widget that shows the
chart.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, floor
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray
from rich.segment import Segment
from rich.style import Style
from textual.events import MouseDown, MouseMove, MouseScrollDown, MouseScrollUp, MouseUp
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from advisor.process.arrays import FloatArray
from advisor.tui.plot.axis import Axis, LogAxis, exact_axis, log_axis, nearest, round_axis
from advisor.tui.plot.chart import INKS, Chart, Ink, Series
from advisor.words.quantities import signed

BLANK = 0x2800
BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.uint8)
"""Bit of each dot in a cell, row by row, in Unicode's order of U+2800..U+28FF."""


class Canvas:
    """A drawing surface of ``columns`` x ``rows`` cells over a rectangle of data.

    A cell has the colour of its last curve, and the dots of all curves remain.

    Parameters
    ----------
    columns, rows : int
        Size in cells, at least 1 each.
    x_range, y_range : tuple of float
        Data values at the outermost dots; each must have lower < upper.
    """

    def __init__(
        self, columns: int, rows: int, x_range: tuple[float, float], y_range: tuple[float, float]
    ) -> None:
        self._width, self._height = 2 * columns, 4 * rows
        self._x0, self._x_scale = x_range[0], (self._width - 1) / (x_range[1] - x_range[0])
        self._y1, self._y_scale = y_range[1], (self._height - 1) / (y_range[1] - y_range[0])
        self._dots = np.zeros((self._height, self._width), dtype=np.uint8)
        self.ink = np.full((rows, columns), -1, dtype=np.int8)
        """Shape (rows, columns). Number of the ink that was last used in each cell; -1 for an empty cell."""

    def points(self, x: FloatArray, y: FloatArray, ink: int) -> None:
        """Set one dot for each sample; samples that are not finite or lie outside are omitted."""
        self._set(*self._place(x, y), ink)

    def line(self, x: FloatArray, y: FloatArray, ink: int) -> None:
        """Draw a polyline. A NaN interrupts the line, and a single sample between two NaN is a point."""
        px, py = self._place(x, y)
        self._set(px, py, ink)
        dx, dy = np.diff(px), np.diff(py)
        drawn = np.isfinite(dx) & np.isfinite(dy)
        start_x, start_y, dx, dy = px[:-1][drawn], py[:-1][drawn], dx[drawn], dy[drawn]
        count = np.ceil(np.maximum(np.abs(dx), np.abs(dy))).astype(np.int64) + 1
        segment = np.repeat(np.arange(len(count)), count)
        along = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)
        share = along / np.maximum(count[segment] - 1, 1)
        self._set(start_x[segment] + share * dx[segment], start_y[segment] + share * dy[segment], ink)

    def bars(self, x: FloatArray, low: FloatArray, high: FloatArray, ink: int) -> None:
        """Draw a vertical line at each x from one value to another."""
        gap = np.full(len(x), np.nan)
        self.line(np.column_stack([x, x, gap]).ravel(), np.column_stack([low, high, gap]).ravel(), ink)

    def dashes(self, x: FloatArray, y: FloatArray, ink: int) -> None:
        """Draw a horizontal line of three dots through each point."""
        px, py = self._place(x, y)
        for dot in (-1.0, 0.0, 1.0):
            self._set(px + dot, py, ink)

    def level(self, y: float, ink: int, dashed: bool = True) -> None:
        """Draw a horizontal line across the whole canvas."""
        px = np.flatnonzero(np.arange(self._width) % 4 < (2 if dashed else 4)).astype(np.float64)
        self._set(px, np.full(len(px), (self._y1 - y) * self._y_scale), ink)

    def upright(self, x: float, ink: int) -> None:
        """Draw a dotted vertical line over the whole canvas."""
        py = np.arange(0.0, self._height, 2.0)
        self._set(np.full(len(py), (x - self._x0) * self._x_scale), py, ink)

    def text(self) -> list[str]:
        """Return the rows as strings, with blanks where nothing was drawn."""
        rows, columns = self.ink.shape
        cells = self._dots.reshape(rows, 4, columns, 2)
        codes = (cells * BITS[None, :, None, :]).sum(axis=(1, 3), dtype=np.uint32) + BLANK
        codes[codes == BLANK] = ord(" ")
        return [str(row) for row in codes.view(f"<U{columns}").ravel()]

    def _place(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        px = (np.asarray(x, dtype=np.float64) - self._x0) * self._x_scale
        py = (self._y1 - np.asarray(y, dtype=np.float64)) * self._y_scale
        # A value far outside would make a segment of millions of dots.
        return (np.clip(px, -self._width, 2.0 * self._width), np.clip(py, -self._height, 2.0 * self._height))

    def _set(self, px: NDArray[np.float64], py: NDArray[np.float64], ink: int) -> None:
        finite = np.isfinite(px) & np.isfinite(py)
        column, row = np.rint(px[finite]).astype(np.int64), np.rint(py[finite]).astype(np.int64)
        inside = (column >= 0) & (column < self._width) & (row >= 0) & (row < self._height)
        column, row = column[inside], row[inside]
        self._dots[row, column] = 1
        self.ink[row // 4, column // 2] = ink


_DIGITS = 4
"""Number of significant digits of the visible length of an axis that a reading resolves."""


def readings(chart: Chart, y_axis: Axis | LogAxis) -> list[str]:
    """Return the text of each series's value at the chart's cursor.

    Returns
    -------
    list of str
        Texts in the order of the series. A text is empty if no sample is near, or without a cursor.
    """
    if chart.cursor is None:
        return [""] * len(chart.series)
    decimals = min(max(_DIGITS - 1 - int(np.floor(np.log10(y_axis.high - y_axis.low))), 0), 6)
    return [
        "" if (value := value_at(series, chart.cursor)) is None else signed(value, decimals)
        for series in chart.series
    ]


def value_at(series: Series, x: float) -> float | None:
    """Return the value of the sample nearest to ``x``; None if the sample is farther away than the distance
    of two samples.
    """
    if len(series.x) == 0:
        return None
    at = nearest(series.x, x)
    apart = float(np.median(np.diff(series.x))) if len(series.x) > 1 else 0.0
    if abs(float(series.x[at]) - x) > max(apart, 1e-9):
        return None
    return float(series.y[at])


_ROWS_PER_TICK, _ROWS_PER_LOG_TICK = 3, 2
_COLUMNS_PER_TICK, _COLUMNS_PER_NUMBER = 12, 4
_LEAST_WIDTH, _LEAST_ROWS = 16, 2


@dataclass(frozen=True, slots=True)
class Painting:
    """The lines of a plot, and the position of the x axis in them."""

    strips: list[Strip]
    gutter: int = 0
    """Number of columns to the left of the canvas."""
    x_axis: Axis | None = None
    """X axis of the plot; None if no curve is painted."""

    def x_at(self, column: int, width: int) -> float | None:
        """Return the value of x at a column of the plot; None if no curve is painted."""
        if self.x_axis is None:
            return None
        share = (column - self.gutter) / max(width - self.gutter - 1, 1)
        return self.x_axis.low + min(max(share, 0.0), 1.0) * (self.x_axis.high - self.x_axis.low)


def paint(chart: Chart, width: int, height: int, base: Style, inks: list[Style]) -> Painting:
    """Paint a chart on ``width`` x ``height`` cells.

    Parameters
    ----------
    width, height
        Size in cells. A plot that is too small shows a sentence instead.
    """
    if not chart.series:
        return Painting(_sentence(f"{chart.y_label}: {chart.why_empty}", width, base))
    rows = height - 2 if chart.foot else height - 1
    if width < _LEAST_WIDTH or rows < _LEAST_ROWS:
        return Painting(_sentence(f"{chart.y_label}: too little room for a plot.", width, base))
    chart = _in_range(chart)
    y_axis = _y_axis(chart, rows)
    gutter = max(chart.gutter, max(len(label) for label in y_axis.labels) + 1)
    columns = max(2, width - gutter)
    x_axis = _x_axis(chart, max(1, columns // (_COLUMNS_PER_NUMBER if chart.whole_x else _COLUMNS_PER_TICK)))
    canvas = Canvas(columns, rows, (x_axis.low, x_axis.high), (y_axis.low, y_axis.high))
    if chart.layer is not None:
        _draw_series(canvas, _scaled(chart.layer, y_axis.low, y_axis.high))
    _draw(canvas, _logarithmic(chart) if chart.log_y else chart)
    side = down_the_side(y_axis, rows, gutter)
    strips = [
        legend(chart, readings(chart, y_axis), width, base, inks),
        *(
            Strip([Segment(side[row], base), *_runs(text, canvas.ink[row], inks, base)], width)
            for row, text in enumerate(canvas.text())
        ),
    ]
    if chart.foot:
        strips.append(Strip([Segment(along_the_foot(x_axis, chart.x_label, gutter, width), base)], width))
    return Painting(strips, gutter, x_axis)


def _x_axis(chart: Chart, intervals: int) -> Axis:
    if chart.x_range is None:
        axis = round_axis([s.x for s in chart.series], intervals)
        return whole(axis) if chart.whole_x else axis
    axis = exact_axis(*chart.x_range, intervals)
    return replace(axis, step=max(1.0, axis.step)) if chart.whole_x else axis


def _y_axis(chart: Chart, rows: int) -> Axis | LogAxis:
    if chart.log_y:
        return log_axis(_heights(chart), max(2, rows // _ROWS_PER_LOG_TICK))
    return round_axis(_heights(chart), max(1, rows // _ROWS_PER_TICK))


def _logarithmic(chart: Chart) -> Chart:
    """Return a chart with the decimal logarithms of its curves and levels; NaN for values that are not
    positive.
    """
    return replace(
        chart,
        series=tuple(replace(s, y=np.log10(np.where(s.y > 0.0, s.y, np.nan))) for s in chart.series),
        levels=tuple(replace(level, y=float(np.log10(level.y))) for level in chart.levels),
    )


def _in_range(chart: Chart) -> Chart:
    """Remove samples outside the range of x. One sample beyond each end stays for lines to the edge."""
    if chart.x_range is None:
        return chart
    return replace(chart, series=tuple(_cut(s, *chart.x_range) for s in chart.series))


def _cut(series: Series, low: float, high: float) -> Series:
    first = max(int(np.searchsorted(series.x, low)) - 1, 0)
    last = int(np.searchsorted(series.x, high, side="right")) + 1
    half = None if series.half is None else series.half[first:last]
    return replace(series, x=series.x[first:last], y=series.y[first:last], half=half)


def _scaled(series: Series, low: float, high: float) -> Series:
    """Return a curve scaled so that its lowest and highest values are ``low`` and ``high``."""
    least, most = float(np.min(series.y)), float(np.max(series.y))
    share = (series.y - least) / (most - least) if most > least else np.full_like(series.y, 0.5)
    return replace(series, y=low + share * (high - low))


def _heights(chart: Chart) -> list[FloatArray]:
    """Return the values that the y axis must include."""
    held = [np.array([level.y]) for level in chart.levels]
    for series in chart.series:
        half = 0.0 if series.half is None else series.half
        held += [series.y - half, series.y + half]
    return held


def _draw(canvas: Canvas, chart: Chart) -> None:
    if chart.cursor is not None:
        canvas.upright(chart.cursor, INKS.index("prior"))
    for level in chart.levels:
        canvas.level(level.y, INKS.index(level.ink), level.dashed)
    for series in chart.series:
        _draw_series(canvas, series)


def _draw_series(canvas: Canvas, series: Series) -> None:
    ink = INKS.index(series.ink)
    if series.mark in ("line", "joined"):
        canvas.line(series.x, series.y, ink)
        if series.mark == "joined":
            canvas.dashes(series.x, series.y, ink)
    elif series.mark == "points":
        canvas.points(series.x, series.y, ink)
    elif series.mark == "stems":
        canvas.bars(series.x, np.zeros(len(series.x)), series.y, ink)
    else:
        half = np.zeros(len(series.x)) if series.half is None else series.half
        canvas.bars(series.x, series.y - half, series.y + half, ink)
        canvas.dashes(series.x, series.y, ink)


def _runs(text: str, ink: NDArray[np.int8], inks: list[Style], base: Style) -> list[Segment]:
    """Yield one segment for each stretch of cells in one colour."""
    edges = [0, *(np.flatnonzero(np.diff(ink)) + 1).tolist(), len(text)]
    styles = [*inks, base]
    return [Segment(text[i:j], styles[ink[i]]) for i, j in pairwise(edges)]


def _sentence(text: str, width: int, style: Style) -> list[Strip]:
    return [Strip([Segment(line.ljust(width), style)], width) for line in wrap(text, max(width, 1))]


def whole(axis: Axis) -> Axis:
    """Return the axis with ticks at whole numbers only."""
    return Axis(floor(axis.low), ceil(axis.high), max(1.0, round(axis.step)))


def down_the_side(axis: Axis | LogAxis, rows: int, gutter: int) -> list[str]:
    """Return the labels of the y axis: one string of ``gutter`` characters for each row, the highest row
    first.
    """
    column = [" " * gutter] * rows
    for tick, label in zip(axis.ticks, axis.labels, strict=True):
        row = round((axis.high - tick) / (axis.high - axis.low) * (rows - 1))
        column[row] = label.rjust(gutter - 1) + " "
    return column


def along_the_foot(axis: Axis, name: str, gutter: int, width: int) -> str:
    """Return the labels of the x axis on one line, with the axis's name at the end. Labels without room are
    left out.
    """
    line = [" "] * width
    columns = width - gutter
    room_until = width - len(name) - 1
    free_from = gutter
    for tick, label in zip(axis.ticks, axis.labels, strict=True):
        centre = gutter + round((tick - axis.low) / (axis.high - axis.low) * (columns - 1))
        at = max(centre - len(label) // 2, gutter)
        if at >= free_from and at + len(label) <= room_until:
            line[at : at + len(label)] = label
            free_from = at + len(label) + 1
    line[room_until + 1 :] = name
    return "".join(line)[:width]


_SAMPLE = {"line": "──", "joined": "──", "points": "∙∙", "stems": "││", "intervals": "├┤"}


def legend(chart: Chart, read: list[str], width: int, style: Style, inks: list[Style]) -> Strip:
    """Return the legend line with as many series as have room, from left to right.

    Parameters
    ----------
    read
        Text of each series's value at the cursor; empty without a cursor.
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


_BOLD: frozenset[Ink] = frozenset({"fitted", "limit"})


class Plot(Widget):
    """Widget that paints a `Chart`. The plot is painted again only after the chart, the size or the theme has
    changed.
    """

    class Pointed(Message):
        """The mouse button was pressed, or the mouse was dragged, at a value of x."""

        def __init__(self, x: float) -> None:
            super().__init__()
            self.x = x

    class Wheeled(Message):
        """The wheel was turned over a value of x."""

        def __init__(self, x: float, up: bool, sideways: bool) -> None:
            super().__init__()
            self.x = x
            self.up = up
            """Whether the wheel was turned away from the user."""
            self.sideways = sideways
            """Whether the shift key was held."""

    def __init__(self, chart: Chart, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self._chart = chart
        self._painting: Painting | None = None

    @property
    def chart(self) -> Chart:
        return self._chart

    @chart.setter
    def chart(self, chart: Chart) -> None:
        if chart is not self._chart:
            self._chart = chart
            self._painting = None
            self.refresh()

    def on_resize(self) -> None:
        """Paint the chart again, because another size needs other ticks."""
        self._painting = None

    def notify_style_update(self) -> None:
        """Paint the chart again, because another theme needs other colours."""
        super().notify_style_update()
        self._painting = None

    def on_mouse_down(self, event: MouseDown) -> None:
        """Report the position of the mouse, and follow the mouse until its button is released."""
        if self._chart.x_range is not None:
            self.capture_mouse()
            self._point(event.x)

    def on_mouse_move(self, event: MouseMove) -> None:
        """Report the position again while the mouse button is down."""
        if self.app.mouse_captured is self:
            self._point(event.x)

    def on_mouse_up(self, event: MouseUp) -> None:
        self.release_mouse()

    def on_mouse_scroll_up(self, event: MouseScrollUp) -> None:
        """Report a turn of the mouse wheel."""
        self._wheel(event, up=True)

    def on_mouse_scroll_down(self, event: MouseScrollDown) -> None:
        """Report a turn of the mouse wheel."""
        self._wheel(event, up=False)

    def _point(self, column: int) -> None:
        x = self._painted().x_at(column, self.size.width)
        if x is not None:
            self.post_message(self.Pointed(x))

    def _wheel(self, event: MouseScrollUp | MouseScrollDown, *, up: bool) -> None:
        x = self._painted().x_at(event.x, self.size.width)
        if x is not None and self._chart.x_range is not None:
            event.stop()
            self.post_message(self.Wheeled(x, up, event.shift))

    def render_line(self, y: int) -> Strip:
        strips = self._painted().strips
        return strips[y] if y < len(strips) else Strip.blank(self.size.width, self.rich_style)

    def _painted(self) -> Painting:
        if self._painting is None:
            base = self.rich_style
            self._painting = paint(self._chart, self.size.width, self.size.height, base, self._inks(base))
        return self._painting

    def _inks(self, base: Style) -> list[Style]:
        """Return the colours of the theme. Textual's component classes would be computed at every change of
        focus.
        """
        colours = self.app.theme_variables
        return [base + Style(color=colours[f"ink-{ink}"], bold=ink in _BOLD) for ink in INKS]
