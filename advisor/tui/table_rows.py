"""Rows with a header, and CSV made from them for the clipboard and for files."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from io import StringIO
from math import isfinite

from advisor.tui.plot.chart import Chart

_DIGITS = 7
"""Significant digits of a number in a table, as many as a log stores (float32)."""


@dataclass(frozen=True, slots=True)
class TableRows:
    """A table of texts and numbers."""

    header: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]

    def csv(self) -> str:
        """Write a header line and one line for each row. An unknown number becomes an empty field."""
        text = StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(self.header)
        lines.writerows([_cell(value) for value in row] for row in self.rows)
        return text.getvalue()


def rows_of_charts(charts: Iterable[Chart]) -> TableRows:
    """Return one row for each sample of each series: quantity, series, x, y."""
    rows: list[tuple[object, ...]] = []
    x_label = "x"
    for chart in charts:
        x_label = chart.x_label or x_label
        for series in chart.series:
            pairs = zip(series.x.tolist(), series.y.tolist(), strict=True)
            rows += [(chart.y_label, series.name, x, y) for x, y in pairs]
    return TableRows(("quantity", "series", x_label, "value"), tuple(rows))


def _cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.{_DIGITS}g}" if isfinite(value) else ""
    return value
