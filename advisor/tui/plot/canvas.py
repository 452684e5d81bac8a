"""Canvas of braille characters, whose terminal cells have 2 x 4 dots each."""

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray

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
