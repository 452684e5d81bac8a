"""Pane of the selected manoeuvre: controls, and measured, fitted and residual curves of every output, with
their charts.
"""

from dataclasses import dataclass, replace

import numpy as np
from textual.app import ComposeResult

from advisor.campaign.state import JudgedManeuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.process.arrays import FloatArray
from advisor.session.conducting import View
from advisor.tui import keys
from advisor.tui.panes.pane import Pane, Redrawn, TableRows
from advisor.tui.plot.axis import Sight, Window
from advisor.tui.plot.chart import Chart, Ink, Mark, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import channel, signed

OUTPUTS = ("alpha", "q", "a_z", "theta")
_T = "t [s]"
_GUTTER = 7
"""Number of columns left of the canvas, wide enough for ``-12.50``. With one width all plots of the pane
begin in one column.
"""

Curve = tuple[FloatArray, FloatArray]
"""Seconds since the start of the input, shape (n,), and values in the unit for people, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Shown:
    """Channels of the axis that the fit pane shows."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


ELEVATOR_AXIS = Shown(("elevator",), OUTPUTS)
SIDE_AXIS = Shown(LATERAL.inputs, LATERAL.outputs)


def since_start(judged: JudgedManeuver, t: FloatArray) -> FloatArray:
    """Return the stamps ``t`` as seconds since the first step of the input."""
    return t - judged.maneuver.span.start_s


def fits_of(judged: JudgedManeuver) -> dict[str, ChannelFit]:
    """Return the fits of a manoeuvre by output; empty without an estimate."""
    return dict(judged.estimate.fits[0]) if isinstance(judged.estimate, Estimate) else {}


def measured(judged: JudgedManeuver, name: str) -> Curve | None:
    """Return the channel's samples that the fit used, else the recorded samples; None for a channel that is
    not recorded.
    """
    factor = channel(name).factor
    fit = fits_of(judged).get(name)
    if fit is not None:
        return since_start(judged, fit.t), fit.measured * factor
    recorded = judged.maneuver.channels.get(name)
    if recorded is None or len(recorded) == 0:
        return None
    return since_start(judged, recorded.t), recorded.y * factor


def extent(judged: JudgedManeuver, over: JudgedManeuver | None) -> tuple[float, float]:
    """Return the first and the last time that the plots show, in seconds since the start of the input."""
    spans = [j.maneuver.span for j in (judged, over) if j is not None]
    first = min(span.record_from_s - span.start_s for span in spans)
    last = max(span.end_s - span.start_s for span in spans)
    return (first, last) if last > first else (first, first + 1.0)


def in_sight(chart: Chart, x_range: tuple[float, float], cursor: float | None, *, foot: bool) -> Chart:
    """Return the visible part of a chart, with a cursor, aligned with the other plots of the pane."""
    return replace(chart, x_range=x_range, cursor=cursor, foot=foot, gutter=_GUTTER)


def input_chart(name: str, judged: JudgedManeuver, over: JudgedManeuver | None) -> Chart:
    """Draw a control of one manoeuvre, or of two manoeuvres."""
    curves = _overlaid(name, measured(judged, name), judged, over, name, "input", "line")
    return Chart(channel(name).label, _T, series=curves, why_empty="the record has none.")


def fit_chart(name: str, judged: JudgedManeuver, over: JudgedManeuver | None) -> Chart:
    """Draw the measured and fitted values of one manoeuvre, or the measured values of two manoeuvres."""
    fit = fits_of(judged).get(name)
    if fit is None:
        return no_fit(name, _why_no_fit(judged))
    if over is not None:
        curves = _overlaid("measured", measured(judged, name), judged, over, name, "measured", "points")
        return Chart(channel(name).label, _T, series=curves)
    t, factor = since_start(judged, fit.t), channel(name).factor
    return Chart(
        channel(name).label,
        _T,
        series=(
            Series("measured", t, fit.measured * factor, "measured", "points"),
            Series("fitted", t, fit.fitted * factor, "fitted"),
        ),
    )


def residual_chart(name: str, judged: JudgedManeuver, over: JudgedManeuver | None) -> Chart:
    """Draw the residual, measured minus fitted, of one manoeuvre or of two manoeuvres."""
    fit = fits_of(judged).get(name)
    if fit is None:
        return no_fit(name, _why_no_fit(judged))
    series = [Series(_named("residual", judged, over), *_residual(judged, fit), "residual")]
    second = fits_of(over).get(name) if over is not None else None
    if over is not None and second is not None:
        series.insert(0, Series(_named("residual", over, judged), *_residual(over, second), "prior"))
    return Chart(channel(name).label, _T, series=tuple(series))


def no_fit(name: str, why: str) -> Chart:
    """Return an empty chart that shows why an output has no fit."""
    return Chart(channel(name).label, _T, why_empty=why)


def rows_of_fit(judged: JudgedManeuver, over: JudgedManeuver | None, axis: Shown) -> TableRows:
    """Return one row per sample of the controls and all outputs, for one manoeuvre or two."""
    header = ("manoeuvre", "channel", "unit", "t_s", "measured", "fitted", "residual")
    return TableRows(header, tuple(row for j in (judged, over) if j is not None for row in _samples(j, axis)))


def _samples(judged: JudgedManeuver, axis: Shown) -> list[tuple[object, ...]]:
    number, rows = judged.maneuver.number, []
    for name in (*axis.inputs, *axis.outputs):
        curve, fit, unit = measured(judged, name), fits_of(judged).get(name), channel(name).unit
        if curve is None:
            continue
        t, y = curve
        empty = np.full(len(t), np.nan)
        fitted = fit.fitted * channel(name).factor if fit is not None else empty
        columns = (values.tolist() for values in (t, y, fitted, y - fitted))
        rows += [(number, name, unit, *sample) for sample in zip(*columns, strict=True)]
    return rows


def _overlaid(
    what: str,
    curve: Curve | None,
    judged: JudgedManeuver,
    over: JudgedManeuver | None,
    name: str,
    ink: Ink,
    mark: Mark,
) -> tuple[Series, ...]:
    """Return the curves of one manoeuvre or of two manoeuvres. The selected manoeuvre is last, so that its
    curve is painted over the other curve.
    """
    if curve is None:
        return ()
    first = Series(_named(what, judged, over), *curve, ink, mark)
    second = measured(over, name) if over is not None else None
    if over is None or second is None:
        return (first,)
    return Series(_named(what, over, judged), *second, "prior"), first


def _named(what: str, judged: JudgedManeuver, beside: JudgedManeuver | None) -> str:
    """Return the name of a curve. With two manoeuvres the name contains the manoeuvre's number."""
    return what if beside is None else f"{what} {judged.maneuver.number}"


def _residual(judged: JudgedManeuver, fit: ChannelFit) -> Curve:
    return since_start(judged, fit.t), fit.residual * channel(fit.name).factor


def _why_no_fit(judged: JudgedManeuver) -> str:
    return (
        "the record has no such channel." if isinstance(judged.estimate, Estimate) else judged.estimate.text
    )


_ROWS_FOR_ONE = 11
"""Number of terminal rows that an output and its residual need if several outputs are shown."""
_LEAST_ROWS_FOR_BOTH = 8
"""Number of rows below which an output has no room for its residual."""
_ROWS_OF_INPUT = 3
_SHARE_OF_INPUT = 8
"""Number of controls' heights in a pane: a control takes an eighth of the rows, and at least
``_ROWS_OF_INPUT`` rows.
"""
_INPUTS = (*ELEVATOR_AXIS.inputs, *SIDE_AXIS.inputs)
_OUTPUTS = (*ELEVATOR_AXIS.outputs, *SIDE_AXIS.outputs)


class Fit(Redrawn, Pane):
    """Plots of the controls, then two plots for each output. One plot shows measured and fitted values, the
    other the residual.
    """

    BINDINGS = keys.FIT
    TITLE = "4 Fit"
    SHORT = "4Fit"
    EITHER_AXIS = True
    OF_SELECTED = True
    HELP = """\
# Fit

The elevator of the selected manoeuvre; below it, for each output, what was measured (dots) and what the
model says (line), and the residual (measured minus fitted). Time counts from the start of the input.
**o** brings the next output to the top when not all have room; what the record lacks is left out. A
residual without pattern is noise; one with a pattern shows an effect that the model lacks.

**left/right** moves a cursor, with **shift** sample by sample; a click sets it. The first line of each
plot reads the values there. **up/down**, **z/Z** or the wheel zooms in time, **<** and **>** move what is
shown, **w** shows the whole record again.

**l** lays a second manoeuvre over this one, aligned at the start of the input: the measured curves and
the residuals of both. The selected manoeuvre keeps its colours, the second is a pale line below; **l**
with 0 takes the second away.
"""

    _first = 0
    _axis = ELEVATOR_AXIS
    _judged: JudgedManeuver | None = None
    _over: JudgedManeuver | None = None
    _over_number: int | None = None
    _sight: Sight | None = None

    def compose(self) -> ComposeResult:
        """Lay out all plots. Plots without room are hidden."""
        for name in _INPUTS:
            yield Plot(no_fit(name, ""), id=f"fit-{name}", classes="input")
        for name in _OUTPUTS:
            yield Plot(no_fit(name, "no manoeuvre has ended yet."), id=f"fit-{name}", classes="fit")
            yield Plot(no_fit(name, ""), id=f"residual-{name}", classes="residual")

    def show(self, view: View) -> None:
        """Draw the selected manoeuvre, and any manoeuvre laid over it, after a change."""
        judged = view.judged
        over = next((j for j in view.state.maneuvers if j.maneuver.number == self._over_number), None)
        over = None if over is judged else over
        if judged is self._judged and over is self._over:
            return
        self._judged, self._over = judged, over
        self._axis = ELEVATOR_AXIS if view.elevator is None else SIDE_AXIS
        if judged is not None:
            first, last = extent(judged, over)
            before = self._sight or Sight(Window.whole(first, last))
            self._sight = before.over(first, last, self._stamps())
        self._redraw()

    def next_output(self) -> None:
        self._first = (self._first + 1) % len(self._outputs())
        self._redraw()

    def lay_over(self, number: int | None) -> None:
        """Choose the manoeuvre that the next ``show`` lays over the selected one. With None, no manoeuvre is
        laid over.
        """
        self._over_number = number

    def rows(self) -> TableRows | None:
        """Return one row for each sample of each channel, visible or not."""
        return rows_of_fit(self._judged, self._over, self._axis) if self._judged is not None else None

    def on_plot_pointed(self, event: Plot.Pointed) -> None:
        """Show the values at the position of the mouse."""
        event.stop()
        self._look(self._sight and self._sight.pointed(event.x, self._stamps()))

    def on_plot_wheeled(self, event: Plot.Wheeled) -> None:
        """Zoom at the mouse position, or pan if the shift key is held."""
        event.stop()
        if event.sideways:
            self.action_pan(-1 if event.up else 1)
        else:
            self._look(self._sight and self._sight.zoomed(1 if event.up else -1, event.x))

    def action_cursor(self, direction: int, finely: bool = False) -> None:
        self._look(self._sight and self._sight.stepped(direction, self._stamps(), finely=finely))

    def action_zoom(self, direction: int) -> None:
        self._look(self._sight and self._sight.zoomed(direction))

    def action_pan(self, direction: int) -> None:
        """Show earlier or later times."""
        self._look(self._sight and self._sight.panned(direction))

    def action_whole(self) -> None:
        self._look(self._sight and self._sight.whole())

    def _look(self, sight: Sight | None) -> None:
        if sight is not None and sight != self._sight:
            self._sight = sight
            self._redraw()

    def _stamps(self) -> FloatArray:
        """Return the time stamps that the cursor steps through: those of the top output, else those of a
        control.
        """
        there = self._outputs()
        for name in (there[self._first % len(there)], *self._axis.inputs):
            curve = measured(self._judged, name) if self._judged is not None else None
            if curve is not None:
                return curve[0]
        return np.zeros(0)

    def _redraw(self) -> None:
        inputs = [name for name in self._axis.inputs if self._has(name)] or self._axis.inputs[:1]
        each = max(_ROWS_OF_INPUT, self.size.height // _SHARE_OF_INPUT)
        above = each * len(inputs)
        there = self._outputs()
        count = min(max(1, (self.size.height - above) // _ROWS_FOR_ONE), len(there))
        shown = [there[(self._first + k) % len(there)] for k in range(count)]
        lowest = max(shown, key=_OUTPUTS.index)
        residuals = self.size.height - above >= _LEAST_ROWS_FOR_BOTH
        for name in _INPUTS:
            self._draw_input(name, name in inputs, each)
        for name in _OUTPUTS:
            self._draw_output(name, name in shown, lowest=name == lowest, with_residual=residuals)
        aligned = "  both start at the first step of the input" if self._over is not None else ""
        more = "" if count == len(there) else "  (o: next output)"
        self.border_title = f"{self.TITLE}{aligned}{more}"
        self._write_subtitle()

    def _outputs(self) -> list[str]:
        """Return the outputs of the fit. Without a fit, return one output, whose plot shows the reason."""
        fits = fits_of(self._judged) if self._judged is not None else {}
        outputs = self._axis.outputs
        return [name for name in outputs if name in fits] or [outputs[0]]

    def _has(self, name: str) -> bool:
        """Return whether a control is recorded and moves in the selected manoeuvre."""
        curve = measured(self._judged, name) if self._judged is not None else None
        return curve is not None and bool(np.ptp(curve[1]) > 0.0)

    def _draw_input(self, name: str, shown: bool, rows: int) -> None:
        plot = self.query_one(f"#fit-{name}", Plot)
        plot.display = shown and self._judged is not None
        plot.styles.height = rows
        if shown and self._judged is not None and self._sight is not None:
            chart = input_chart(name, self._judged, self._over)
            plot.chart = in_sight(chart, self._sight.window.shown, self._sight.cursor, foot=False)

    def _draw_output(self, name: str, shown: bool, *, lowest: bool, with_residual: bool) -> None:
        fit, residual = self.query_one(f"#fit-{name}", Plot), self.query_one(f"#residual-{name}", Plot)
        if self._judged is not None and self._sight is not None:
            window, cursor = self._sight.window.shown, self._sight.cursor
            charts = fit_chart(name, self._judged, self._over), residual_chart(name, self._judged, self._over)
            fit.chart = in_sight(charts[0], window, cursor, foot=lowest and not with_residual)
            residual.chart = in_sight(charts[1], window, cursor, foot=lowest)
        fit.display = shown
        residual.display = shown and with_residual and bool(residual.chart.series)

    def _write_subtitle(self) -> None:
        if self._judged is None or self._sight is None:
            return
        number, cursor = self._judged.maneuver.number, self._sight.cursor
        said = [] if cursor is None else [f"t {signed(cursor, 3)} s"]
        if self._over is None:
            said.append(f"manoeuvre {number}")
        else:
            said.append(f"manoeuvres {number} and {self._over.maneuver.number}")
        if self._sight.window.zoomed:
            said.append("w: whole record")
        self.subtitle("  ".join(said))
