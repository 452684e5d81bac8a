"""Panes of a course over the manoeuvres: the stop criterion, and every parameter's estimate."""

from dataclasses import dataclass, replace

import numpy as np
from textual.app import ComposeResult

from advisor.aircraft.reference import PARAMETERS as NAMES
from advisor.decision.verdict import FlightTestVerdict
from advisor.process.arrays import FloatArray
from advisor.report.facts.estimates import of_all, of_one
from advisor.session.conducting import View
from advisor.tui.panes.pane import Labelled, Pane, Redrawn, TableRows, TextPane
from advisor.tui.plot.chart import Chart, Ink, Level, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import PARAMETERS, SIDE_PARAMETERS, distinct_texts

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


RULE_INKS: dict[str, Ink] = {"continuous": "measured", "separate": "residual", "information": "input"}

_Y, _X = "[% of limit]", "manoeuvre"


_MULTIPLE_PERCENT = 1000.0
"""Least criterion, % of its limit, that is written as a multiple of the limit: ten times."""


class Criterion(TextPane):
    """Criterion of each stopping rule against its limit, and each rule's decision."""

    TITLE = "6 Criterion"
    SHORT = "6Cri"
    EITHER_AXIS = True
    HELP = """\
# Criterion

The stop criterion after each manoeuvre for the three rules, as it was told at that time. Each rule is in per
cent of its own limit, as a line and as a curve on a logarithmic axis: the test may stop below the dashed
line, at 100 %. The rule that decides is marked **►**; the other rules are always shown as well.

Where later estimates give another criterion, a line below the rule says so.

The rule information stops when the 95 % band of the predicted response, each named derivative and the
prediction of the newest manoeuvre are within their tolerances; the lines above the curves tell how far.
"""

    def compose(self) -> ComposeResult:
        """Lay out one line for each rule above the curves."""
        yield from super().compose()
        yield Plot(_chart(None))

    def show(self, view: View) -> None:
        """Draw the histories of the criteria after the verdict has changed."""
        verdict = view.state.flight_test
        if not self.changed(verdict):
            return
        self.query_one(Plot).chart = _chart(verdict)
        self.write(_rows(verdict))


def share_of_limit(percent: float) -> str:
    """Return a criterion relative to its limit, in per cent. A criterion of at least ten times its limit is a
    multiple.
    """
    if percent >= _MULTIPLE_PERCENT:
        return f"{0.01 * percent:.0f} times its limit"
    return f"{distinct_texts(percent, 100.0)[0]} % of its limit"


def _rows(verdict: FlightTestVerdict) -> list[Labelled]:
    rows: list[Labelled] = []
    for rule, progress in verdict.by_rule.items():
        now = progress.now_percent_of_limit
        so_far = f"{'too few manoeuvres' if now is None else share_of_limit(now):>21}"
        says = f"stop since {progress.stopped_at}" if progress.stopped_at else "continue"
        mark = "►" if rule == verdict.rule else " "
        rows.append((f"{mark} ", f"{rule:<12}{so_far}  {says}"))
        if progress.hindsight:
            rows.append(("  ", f"{'':<12}{progress.hindsight}"))
    rows += [("  ", line) for line in verdict.evidence]
    return rows + [("! ", warning) for warning in verdict.warnings]


def _chart(verdict: FlightTestVerdict | None) -> Chart:
    series = []
    rules = verdict.by_rule.items() if verdict else ()
    for rule, progress in sorted(rules, key=lambda item: verdict is None or item[0] != verdict.rule):
        share = np.array([np.nan if v is None else v for v in progress.percent_of_limit], dtype=np.float64)
        if np.isfinite(share).any():
            numbers = np.arange(1.0, len(share) + 1.0)
            ink = RULE_INKS.get(rule, "prior")
            series.append(Series(rule, numbers, share, ink, "joined"))
    if verdict is None or not series:
        return Chart(_Y, _X, why_empty="too few accepted manoeuvres for any rule yet.")
    return Chart(_Y, _X, series=tuple(series), levels=(Level("limit", 100.0),), whole_x=True, log_y=True)
