"""The history of every parameter's estimate over the manoeuvres, at a glance."""

from dataclasses import replace

from textual.app import ComposeResult
from textual.events import Resize

from advisor.aircraft.reference import PARAMETERS as NAMES
from advisor.session.view import View
from advisor.tui.panes.history import course, history_chart
from advisor.tui.panes.pane import Pane
from advisor.tui.plot.chart import Chart
from advisor.tui.plot.widget import Plot
from advisor.tui.rows import TableRows
from advisor.words.quantities import PARAMETERS

_MANY = 4
"""Plots that stand side by side without room for the name of their x axis."""


class Courses(Pane):
    """Eight small plots: each manoeuvre's estimate with its interval against the manoeuvre's number."""

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

    def compose(self) -> ComposeResult:
        """Lay out one plot for each parameter."""
        for name in NAMES:
            yield Plot(history_chart(None, name), id=f"course-{name}")

    def on_mount(self) -> None:
        """Begin without an estimate."""
        super().on_mount()
        self._view: View | None = None

    def show(self, view: View) -> None:
        """Draw all courses when an estimate changed."""
        if self.changed(view.state.maneuvers, view.state.model):
            self._view = view
            self._draw()

    def on_resize(self, event: Resize) -> None:
        """Number the manoeuvres only under the lowest plots on a small terminal, where the others have no
        room."""
        self._draw()

    def _draw(self) -> None:
        across = self.styles.grid_size_columns
        for k, name in enumerate(NAMES):
            lowest, roomy = k >= len(NAMES) - across, across < _MANY
            small = _small(history_chart(self._view, name), "no." if roomy else "", foot=lowest)
            self.query_one(f"#course-{name}", Plot).chart = small
        if self._view and self._view.state.maneuvers:
            self.subtitle("├┤ ± 95 %  ── joint  ╌╌ simulator")

    def rows(self) -> TableRows:
        """Give one row for each manoeuvre and parameter."""
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
    """Remove the names that the frame of the pane gives for all plots."""
    series = tuple(replace(one, name="") for one in chart.series)
    levels = tuple(replace(one, name="") for one in chart.levels)
    return replace(chart, x_label=x_label, foot=foot, series=series, levels=levels)
