"""The history of every parameter's estimate over the manoeuvres, at a glance."""

from dataclasses import dataclass, replace

import numpy as np
from textual.app import ComposeResult

from advisor.aircraft.reference import PARAMETERS as NAMES
from advisor.process.arrays import FloatArray
from advisor.report.facts.estimates import of_all, of_one
from advisor.session.view import View
from advisor.tui.panes.lines import Redrawn
from advisor.tui.panes.pane import Pane, TableRows
from advisor.tui.plot.chart import Chart, Level, Series
from advisor.tui.plot.widget import Plot
from advisor.words.quantities import PARAMETERS, SIDE_PARAMETERS

_MANY = 4
"""Number of plots in a row above which the name of the x axis has no room."""


class Courses(Redrawn, Pane):
    """Eight small plots. Each plot shows one parameter's estimate and interval against the manoeuvre's
    number.
    """

    OF_ELEVATOR = True
    TITLE = "h History"
    SHORT = "hHis"
    HELP = """\
# History

All eight parameters at a glance: each manoeuvre's estimate with its 95 % interval (1.96 σ, corrected for
coloured residuals) against the number of the manoeuvre. The solid line is the joint estimate, the dashed
line the aircraft file's model. A manoeuvre without information about a parameter has no bar.

An interval that excludes the joint estimate shows a manoeuvre that disagrees; a row of intervals that
drifts shows an aircraft that changes.
"""

    _view: View | None = None

    def compose(self) -> ComposeResult:
        """Lay out one plot for each parameter."""
        for name in NAMES:
            yield Plot(history_chart(None, name), id=f"course-{name}")

    def show(self, view: View) -> None:
        """Draw the history of all parameters after an estimate has changed."""
        if self.changed(view.state.maneuvers, view.state.model):
            self._view = view
            self._redraw()

    def _redraw(self) -> None:
        """Draw all plots. On a small terminal only the lowest plots have manoeuvre numbers."""
        across = self.styles.grid_size_columns
        for k, name in enumerate(NAMES):
            lowest, roomy = k >= len(NAMES) - across, across < _MANY
            small = _small(history_chart(self._view, name), "no." if roomy else "", foot=lowest)
            self.query_one(f"#course-{name}", Plot).chart = small
        if self._view and self._view.state.maneuvers:
            self.subtitle("├┤ ± 95 %  ── joint  ╌╌ simulator")

    def rows(self) -> TableRows:
        header = (
            "parameter",
            "unit",
            "manoeuvre",
            "estimate",
            "half_of_95_percent",
            "joint",
            "aircraft_file",
        )
        rows = []
        for name in NAMES:
            of = course(self._view, name)
            rows += [
                (name, PARAMETERS[name].unit, int(number), value, half, of.model, of.prior)
                for number, value, half in zip(of.numbers, of.value, of.half, strict=True)
            ]
        return TableRows(header, tuple(rows))


def _small(chart: Chart, x_label: str, *, foot: bool) -> Chart:
    """Return a chart without the names that the pane's frame shows for all plots."""
    series = tuple(replace(line, name="") for line in chart.series)
    levels = tuple(replace(level, name="") for level in chart.levels)
    return replace(chart, x_label=x_label, foot=foot, series=series, levels=levels)


_MARGIN = 0.5
"""Margin of the x axis before the first manoeuvre and after the last one, in manoeuvres. With the margin no
bar stands on the edge of a plot.
"""


@dataclass(frozen=True, slots=True)
class ParameterCourse:
    """Estimates of one parameter over the manoeuvres, with the joint estimate and the file's value. All
    values are in the unit for people.
    """

    parameter: str
    numbers: FloatArray
    """Shape (n,), numbers of the manoeuvres that determine the parameter."""
    value: FloatArray
    """Shape (n,), the parameter's value from each manoeuvre."""
    half: FloatArray
    """Shape (n,), half of each 95 % interval: 1.96 σ, corrected for coloured residuals."""
    model: float | None
    """The parameter's joint estimate; None without an estimate of this parameter."""
    prior: float | None
    """The parameter's value in the aircraft file; None without one."""


def course(view: View | None, name: str) -> ParameterCourse:
    """Collect one parameter's estimates, manoeuvre by manoeuvre."""
    prior = view.aircraft.model if view else {}
    rows = [
        (judged.maneuver.number, of_one(name, judged, prior))
        for judged in (view.state.maneuvers if view else ())
    ]
    points = [(number, row) for number, row in rows if row.is_known]
    joint = of_all(name, view.state, prior) if view else of_one(name, None, prior)
    return ParameterCourse(
        name,
        np.array([number for number, _ in points], dtype=np.float64),
        np.array([row.value for _, row in points], dtype=np.float64),
        np.array([row.half for _, row in points], dtype=np.float64),
        joint.value if joint.is_known else None,
        joint.prior,
    )


def history_chart(view: View | None, name: str) -> Chart:
    """Draw each manoeuvre's value with its 95 % interval, and the joint estimate and the file's value as
    levels."""
    quantity, of = {**PARAMETERS, **SIDE_PARAMETERS}[name], course(view, name)
    if len(of.numbers) == 0:
        return Chart(
            quantity.label, "manoeuvre", why_empty="no manoeuvre has given an estimate of this parameter yet."
        )
    levels = []
    if of.model is not None:
        levels.append(Level("joint", of.model, "fitted", dashed=False))
    if of.prior is not None:
        levels.append(Level("simulator", of.prior, "prior"))
    values = Series("value ± 95 %", of.numbers, of.value, "measured", "intervals", of.half)
    return Chart(
        quantity.label,
        "manoeuvre",
        series=(values,),
        levels=tuple(levels),
        whole_x=True,
        x_range=(float(of.numbers[0]) - _MARGIN, float(of.numbers[-1]) + _MARGIN),
    )
