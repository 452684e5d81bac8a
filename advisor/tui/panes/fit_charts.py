"""Charts of the fit pane, for one manoeuvre or for two manoeuvres laid over each other."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.campaign.state import JudgedManeuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.process.arrays import FloatArray
from advisor.tui.panes.pane import TableRows
from advisor.tui.plot.chart import Chart, Ink, Mark, Series
from advisor.words.quantities import channel

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
