"""Values of a chart at its cursor."""

import numpy as np

from advisor.tui.plot.axis import Axis, LogAxis
from advisor.tui.plot.chart import Chart, Series
from advisor.tui.plot.window import nearest
from advisor.words.digits import signed

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
