"""Measured and fitted response of each accepted manoeuvre, with the residual and its 95 % band."""

from collections.abc import Iterator

from matplotlib.figure import Figure as Drawing

from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, picture
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import CHANNELS

_EXPLAINED = (
    "Grey: measured. Dark dashes: the short-period model fitted to this manoeuvre alone. "
    "Below: the residual, measured minus fitted. "
    "The band of ±1.96 σ holds 95 % of the residuals if they are white noise. "
    "A pattern in the residual shows an effect that the model lacks."
)


def fits(content: Content) -> Section:
    """Return a gallery for each accepted manoeuvre."""
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
    svg = picture(f"input-{number}", 4.4, 2.7, _paint_input, elevator, span.start_s)
    yield Figure(svg, f"Manoeuvre {number}, {span.kind}: elevator command δe.", "half")
    for name, fit in estimate.fits[0].items():
        quantity = CHANNELS[name]
        rms = f"{fit.rms * quantity.factor:.3g} {quantity.unit}"
        svg = picture(f"fit-{number}-{name}", 4.4, 2.7, _paint, fit, span.start_s)
        yield Figure(
            svg,
            f"Manoeuvre {number}, {quantity.symbol}: R² {fit.r2:.3f}, Theil {fit.tic:.3f}, "
            f"rms of the residual {rms}.{_prediction(estimate, name)}",
            "half",
        )


def _prediction(estimate: Estimate, name: str) -> str:
    band = estimate.prediction.get(name)
    return (
        ""
        if band is None
        else f" The predicted response is known to {100.0 * band:.1f} % of its peak (95 %)."
    )


def _paint_input(drawing: Drawing, elevator: Channel, start_s: float) -> None:
    axes = drawing.subplots()
    quantity = CHANNELS["elevator"]
    axes.plot(elevator.t - start_s, elevator.y * quantity.factor, color=BLACK)
    axes.set(xlabel="time since the first step [s]", ylabel=quantity.label)


def _paint(drawing: Drawing, fit: ChannelFit, start_s: float) -> None:
    quantity = CHANNELS[fit.name]
    factor, unit = quantity.factor, quantity.unit
    above, below = drawing.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    t = fit.t - start_s
    above.plot(t, fit.measured * factor, color=GREY, linewidth=1.8, label="measured")
    above.plot(t, fit.fitted * factor, color=BLUE, linestyle=(0, (4, 1.5)), label="fitted")
    above.set_ylabel(quantity.label)
    above.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2)
    half = NORMAL_95 * fit.noise * factor
    below.axhspan(-half, half, facecolor="#cfe0ef", edgecolor=BLUE, linewidth=0.5, linestyle=":")
    below.plot(t, fit.residual * factor, color=ORANGE, linewidth=0.7)
    below.set(xlabel="time since the first step [s]", ylabel=f"residual [{unit}]")
    drawing.align_ylabels([above, below])
