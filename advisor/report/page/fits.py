"""Measured and fitted response of each accepted manoeuvre: inputs and outputs over one time axis."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.report.page.blocks import Block, Content, Figure, Gallery, Paragraph, section
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, picture
from advisor.words.quantities import CHANNELS, NORMAL_95

_EXPLAINED = (
    "Grey: measured. Dark dashes: the {model} fitted to this manoeuvre alone. "
    "Below each output: the residual, measured minus fitted. "
    "The band of ±1.96 σ holds 95 % of the residuals if they are white noise. "
    "A pattern in the residual shows an effect that the model lacks."
)
_SMALL = ("alpha", "q", "p", "r")
"""Outputs that a small picture shows."""

_FEW = 8
"""Largest number of small pictures in rows of four. More pictures are in rows of six, so that thirty fill one
page."""
Size = Literal["quarter", "sixth"]
Fitted = tuple[JudgedManeuver, Estimate]
Inputs = Mapping[str, Channel]


@section("fits", "Measured against fitted")
def fits(content: Content) -> Iterator[Block]:
    """Yield the fits of pitch."""
    yield from fit_blocks(content.state.maneuvers, ("elevator",), "short-period model")


def fit_blocks(
    maneuvers: Sequence[JudgedManeuver], controls: Sequence[str], model: str, name: str = "fit"
) -> Iterator[Block]:
    """Yield the best and the worst fit of an axis as large pictures, then all other fits as small pictures.

    Parameters
    ----------
    model
        Name of the axis' model for people.
    name
        Beginning of the pictures' names, which are unique on a page.
    """
    accepted: list[Fitted] = [
        (j, j.estimate) for j in maneuvers if j.verdict.accepted and isinstance(j.estimate, Estimate)
    ]
    if not accepted:
        yield Paragraph("No manoeuvre is accepted.")
        return
    yield Paragraph(_EXPLAINED.format(model=model))
    in_order = sorted(accepted, key=lambda fitted: fmean(f.r2 for f in fitted[1].fits[0].values()))
    large = [("worst", in_order[0]), ("best", in_order[-1])] if len(in_order) > 1 else [("only", in_order[0])]
    yield Gallery(tuple(_large(rank, name, controls, *fitted) for rank, fitted in large))
    shown = {judged.maneuver.number for _, (judged, _) in large}
    if small := [fitted for fitted in accepted if fitted[0].maneuver.number not in shown]:
        size: Size = "quarter" if len(small) <= _FEW else "sixth"
        yield Gallery(tuple(_small(size, name, controls, *fitted) for fitted in small))


def _large(
    rank: str, name: str, controls: Sequence[str], judged: JudgedManeuver, estimate: Estimate
) -> Figure:
    number, outputs = judged.maneuver.number, tuple(estimate.fits[0].values())
    inputs = _inputs(judged, controls)
    height = 0.45 + 0.45 * len(inputs) + 1.45 * len(outputs)
    svg = picture(f"{name}-{number}", 3.6, height, _paint_large, inputs, outputs, _start(judged))
    measures = "; ".join(_measures(fit, estimate) for fit in outputs)
    caption = f"Manoeuvre {number}, {judged.maneuver.span.kind}, the {rank} fit. {measures}."
    return Figure(svg, caption, "half")


def _small(
    size: Size, name: str, controls: Sequence[str], judged: JudgedManeuver, estimate: Estimate
) -> Figure:
    number, inputs = judged.maneuver.number, _inputs(judged, controls)
    outputs = tuple(fit for output, fit in estimate.fits[0].items() if output in _SMALL)
    height = 0.45 + 0.3 * len(inputs) + 0.65 * len(outputs)
    svg = picture(f"{name}-{number}", 2.0, height, _paint_small, inputs, outputs, _start(judged))
    measures = ", ".join(f"{CHANNELS[fit.name].symbol} R² {fit.r2:.3f}" for fit in estimate.fits[0].values())
    return Figure(svg, f"Manoeuvre {number}, {judged.maneuver.span.kind}: {measures}.", size)


def _measures(fit: ChannelFit, estimate: Estimate) -> str:
    quantity, band = CHANNELS[fit.name], estimate.prediction.get(fit.name)
    accuracy = "" if band is None else f", known to {100.0 * band:.1f} % of its peak (95 %)"
    rms = f"{fit.rms * quantity.factor:.3g} {quantity.unit}"
    return f"{quantity.symbol}: R² {fit.r2:.3f}, Theil {fit.tic:.3f}, residual {rms} rms{accuracy}"


def _inputs(judged: JudgedManeuver, controls: Sequence[str]) -> Inputs:
    return {name: c for name in controls if (c := judged.maneuver.channels.get(name)) is not None}


def _start(judged: JudgedManeuver) -> float:
    return judged.maneuver.span.start_s


def _paint_large(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    heights = [*(1.0 for _ in inputs), *(h for _ in outputs for h in (1.5, 0.8))]
    rows = drawing.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    for axes, (name, channel) in zip(rows, inputs.items(), strict=False):
        _paint_input(axes, name, channel, start_s)
    first = len(inputs)
    for k, fit in enumerate(outputs):
        curves, below = rows[first + 2 * k], rows[first + 1 + 2 * k]
        _paint_output(curves, fit, start_s)
        quantity = CHANNELS[fit.name]
        half = NORMAL_95 * fit.noise * quantity.factor
        below.axhspan(-half, half, facecolor="#cfe0ef", edgecolor=BLUE, linewidth=0.5, linestyle=":")
        below.plot(fit.t - start_s, fit.residual * quantity.factor, color=ORANGE, linewidth=0.7)
        below.set_ylabel("residual")
        below.locator_params(axis="y", nbins=3)
    rows[first].legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2)
    rows[-1].set_xlabel("time since the first step [s]")
    drawing.align_ylabels(list(rows))


def _paint_small(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    rows = list(drawing.subplots(len(inputs) + len(outputs), 1, sharex=True, squeeze=False)[:, 0])
    for axes, (name, channel) in zip(rows, inputs.items(), strict=False):
        _paint_input(axes, name, channel, start_s)
    for axes, fit in zip(rows[len(inputs) :], outputs, strict=True):
        _paint_output(axes, fit, start_s)
    for axes in rows:
        axes.locator_params(axis="y", nbins=3)
        axes.tick_params(labelsize=6)
        axes.yaxis.label.set_fontsize(6)
    drawing.align_ylabels(rows)


def _paint_input(axes: Axes, name: str, moved: Channel, start_s: float) -> None:
    """Draw a control over the time since the first step."""
    quantity = CHANNELS[name]
    axes.plot(moved.t - start_s, moved.y * quantity.factor, color=BLACK, linewidth=0.9)
    axes.set_ylabel(quantity.label)


def _paint_output(axes: Axes, fit: ChannelFit, start_s: float) -> None:
    """Draw an output, measured and fitted, over the time since the first step."""
    quantity, t = CHANNELS[fit.name], fit.t - start_s
    axes.plot(t, fit.measured * quantity.factor, color=GREY, linewidth=1.8, label="measured")
    axes.plot(
        t, fit.fitted * quantity.factor, color=BLUE, linestyle=(0, (4, 1.5)), linewidth=1.0, label="fitted"
    )
    axes.set_ylabel(quantity.label)
