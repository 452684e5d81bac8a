"""Values of a chart at its cursor."""

import numpy as np

from advisor.tui.plot.axis import Axis, LogAxis
from advisor.tui.plot.chart import Chart, Series
from advisor.tui.plot.window import nearest
from advisor.words.digits import signed

_DIGITS = 4
"""Digits for the length of an axis: one part in a thousand or less of what can be seen."""


def readings(chart: Chart, y_axis: Axis | LogAxis) -> list[str]:
    """Write the value of each series at the chart's cursor; nothing where no sample is near.

    Returns
    -------
    list of str
        One text a series, in order; all empty without a cursor.
    """
    if chart.cursor is None:
        return [""] * len(chart.series)
    decimals = min(max(_DIGITS - 1 - int(np.floor(np.log10(y_axis.high - y_axis.low))), 0), 6)
    return [
        "" if (value := value_at(series, chart.cursor)) is None else signed(value, decimals)
        for series in chart.series
    ]


def value_at(series: Series, x: float) -> float | None:
    """Return the sample nearest to ``x``; None where it is farther than two samples are apart."""
    if len(series.x) == 0:
        return None
    at = nearest(series.x, x)
    apart = float(np.median(np.diff(series.x))) if len(series.x) > 1 else 0.0
    if abs(float(series.x[at]) - x) > max(apart, 1e-9):
        return None
    return float(series.y[at])
