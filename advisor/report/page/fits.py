"""Measured against fitted of each accepted manoeuvre, with the residual and its 95 % band."""

from collections.abc import Iterator
from math import degrees

from matplotlib.figure import Figure as Drawing

from advisor.campaign_state import JudgedManeuver
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, draw

_DEG = degrees(1.0)
_LABELS = {
    "alpha": ("α", "deg", _DEG),
    "q": ("q", "deg/s", _DEG),
    "theta": ("θ", "deg", _DEG),
    "a_z": ("a_z", "m/s²", 1.0),
}
_NORMAL_95 = 1.959963984540054
_EXPLAINED = (
    "Grey: measured. Dark dashes: the short-period model fitted to this manoeuvre alone. "
    "Below: the residual, measured minus fitted. "
    "The band of ±1.96 σ holds 95 % of the residuals if they are white noise. "
    "A pattern in the residual is something the model does not know."
)


def fits(content: Content) -> Section:
    """A gallery for each accepted manoeuvre."""
    return Section("fits", "Measured against fitted", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    accepted = [j for j in content.state.maneuvers if j.verdict.accepted]
    yield Paragraph(_EXPLAINED if accepted else "No manoeuvre is accepted.")
    for judged in accepted:
        if isinstance(judged.estimate, Estimate):
            yield Gallery(tuple(_figures(judged, judged.estimate)))


def _figures(judged: JudgedManeuver, estimate: Estimate) -> Iterator[Figure]:
    number, span = judged.maneuver.number, judged.maneuver.span
    elevator = judged.maneuver.channels["elevator"]
    svg = draw(
        f"input-{number}", 4.4, 2.7, lambda d: _paint_input(d, elevator.t - span.start_s, elevator.y * _DEG)
    )
    yield Figure(svg, f"Manoeuvre {number}, {span.kind}: elevator command δe.", "half")
    for name, fit in estimate.fits[0].items():
        symbol, unit, factor = _LABELS[name]
        svg = draw(f"fit-{number}-{name}", 4.4, 2.7, lambda d, f=fit: _paint(d, f, span.start_s))  # type: ignore[misc]
        band = estimate.prediction.get(name)
        told = (
            ""
            if band is None
            else f" The predicted response is known to {100.0 * band:.1f} % of its peak (95 %)."
        )
        yield Figure(
            svg,
            f"Manoeuvre {number}, {symbol}: R² {fit.r2:.3f}, Theil {fit.tic:.3f}, "
            f"rms of the residual {fit.rms * factor:.3g} {unit}.{told}",
            "half",
        )


def _paint_input(drawing: Drawing, t: object, y: object) -> None:
    axes = drawing.subplots()
    axes.plot(t, y, color=BLACK)  # type: ignore[arg-type]
    axes.set(xlabel="time since the first step [s]", ylabel="δe [deg]")


def _paint(drawing: Drawing, fit: ChannelFit, start_s: float) -> None:
    symbol, unit, factor = _LABELS[fit.name]
    above, below = drawing.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    t = fit.t - start_s
    above.plot(t, fit.measured * factor, color=GREY, linewidth=1.8, label="measured")
    above.plot(t, fit.fitted * factor, color=BLUE, linestyle=(0, (4, 1.5)), label="fitted")
    above.set_ylabel(f"{symbol} [{unit}]")
    above.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2)
    half = _NORMAL_95 * fit.noise * factor
    below.axhspan(-half, half, facecolor="#cfe0ef", edgecolor=BLUE, linewidth=0.5, linestyle=":")
    below.plot(t, fit.residual * factor, color=ORANGE, linewidth=0.7)
    below.set(xlabel="time since the first step [s]", ylabel=f"residual [{unit}]")
    drawing.align_ylabels([above, below])
