"""Measured and fitted response of each accepted manoeuvre: inputs and outputs over one time axis."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from statistics import fmean
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, picture
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import CHANNELS

_EXPLAINED = (
    "Grey: measured. Dark dashes: the short-period model fitted to this manoeuvre alone. "
    "Below each output: the residual, measured minus fitted. "
    "The band of ±1.96 σ holds 95 % of the residuals if they are white noise. "
    "A pattern in the residual shows an effect that the model lacks."
)
_SMALL = ("alpha", "q")
"""Outputs in a small picture."""

_FEW = 8
"""Largest number of small pictures in rows of four. More pictures are in rows of six, so that thirty fill one
page."""
Size = Literal["quarter", "sixth"]
Fitted = tuple[JudgedManeuver, Estimate]


@section("fits", "Measured against fitted")
def fits(content: Content) -> Iterator[Block]:
    """Yield the best and the worst fit as large pictures, then all others as small ones."""
    accepted: list[Fitted] = [
        (j, j.estimate)
        for j in content.state.maneuvers
        if j.verdict.accepted and isinstance(j.estimate, Estimate)
    ]
    if not accepted:
        yield Paragraph("No manoeuvre is accepted.")
        return
    yield Paragraph(_EXPLAINED)
    in_order = by_fit(accepted)
    large = [("worst", in_order[0]), ("best", in_order[-1])] if len(in_order) > 1 else [("only", in_order[0])]
    yield Gallery(tuple(_large(rank, *one) for rank, one in large))
    shown = {one.maneuver.number for _, (one, _) in large}
    if small := [one for one in accepted if one[0].maneuver.number not in shown]:
        size: Size = "quarter" if len(small) <= _FEW else "sixth"
        yield Gallery(tuple(_small(size, *one) for one in small))


def by_fit(fitted: Iterable[Fitted]) -> list[Fitted]:
    """Return the manoeuvres sorted by the mean share of the motion that their fit explains."""
    return sorted(fitted, key=lambda one: fmean(fit.r2 for fit in one[1].fits[0].values()))


def caption_of(judged: JudgedManeuver, estimate: Estimate) -> str:
    """Return a manoeuvre's number and input, and the share of each output that its fit explains."""
    told = ", ".join(f"{CHANNELS[fit.name].symbol} R² {fit.r2:.3f}" for fit in estimate.fits[0].values())
    return f"Manoeuvre {judged.maneuver.number}, {judged.maneuver.span.kind}: {told}."


def _large(rank: str, judged: JudgedManeuver, estimate: Estimate) -> Figure:
    number, outputs = judged.maneuver.number, tuple(estimate.fits[0].values())
    height = 0.9 + 1.45 * len(outputs)
    svg = picture(f"fit-{number}", 3.6, height, _paint_large, _elevator(judged), outputs, _start(judged))
    told = "; ".join(_measures(fit, estimate) for fit in outputs)
    caption = f"Manoeuvre {number}, {judged.maneuver.span.kind}, the {rank} fit. {told}."
    return Figure(svg, caption, "half")


def _small(size: Size, judged: JudgedManeuver, estimate: Estimate) -> Figure:
    number, all_of_them = judged.maneuver.number, estimate.fits[0]
    outputs = tuple(all_of_them[name] for name in _SMALL if name in all_of_them)
    svg = picture(
        f"fit-{number}", 2.0, 0.75 + 0.65 * len(outputs), _paint_small, {"elevator": _elevator(judged)},
        outputs, _start(judged),
    )  # fmt: skip
    return Figure(svg, caption_of(judged, estimate), size)


def _measures(fit: ChannelFit, estimate: Estimate) -> str:
    quantity, band = CHANNELS[fit.name], estimate.prediction.get(fit.name)
    known = "" if band is None else f", known to {100.0 * band:.1f} % of its peak (95 %)"
    rms = f"{fit.rms * quantity.factor:.3g} {quantity.unit}"
    return f"{quantity.symbol}: R² {fit.r2:.3f}, Theil {fit.tic:.3f}, residual {rms} rms{known}"


def _elevator(judged: JudgedManeuver) -> Channel:
    return judged.maneuver.channels["elevator"]


def _start(judged: JudgedManeuver) -> float:
    return judged.maneuver.span.start_s


def _paint_large(drawing: Drawing, elevator: Channel, outputs: Sequence[ChannelFit], start_s: float) -> None:
    heights = [1.0, *(h for _ in outputs for h in (1.5, 0.8))]
    rows = drawing.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    _paint_input(rows[0], "elevator", elevator, start_s)
    for k, fit in enumerate(outputs):
        curves, below = rows[1 + 2 * k], rows[2 + 2 * k]
        _paint_output(curves, fit, start_s)
        quantity = CHANNELS[fit.name]
        half = NORMAL_95 * fit.noise * quantity.factor
        below.axhspan(-half, half, facecolor="#cfe0ef", edgecolor=BLUE, linewidth=0.5, linestyle=":")
        below.plot(fit.t - start_s, fit.residual * quantity.factor, color=ORANGE, linewidth=0.7)
        below.set_ylabel("residual")
        below.locator_params(axis="y", nbins=3)
    rows[1].legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2)
    rows[-1].set_xlabel("time since the first step [s]")
    drawing.align_ylabels(list(rows))


Inputs = Mapping[str, Channel]


def _paint_small(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    for axes in _rows(drawing, inputs, outputs, start_s, ticks=3):
        axes.tick_params(labelsize=6)
        axes.yaxis.label.set_fontsize(6)


def paint_rows(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    """Draw controls and outputs, measured and fitted, over the time since the first step."""
    *_, last = _rows(drawing, inputs, outputs, start_s, ticks=4)
    last.set_xlabel("time since the first step [s]")


def _rows(
    drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float, ticks: int
) -> list[Axes]:
    rows = list(drawing.subplots(len(inputs) + len(outputs), 1, sharex=True, squeeze=False)[:, 0])
    for axes, (name, channel) in zip(rows, inputs.items(), strict=False):
        _paint_input(axes, name, channel, start_s)
    for axes, fit in zip(rows[len(inputs) :], outputs, strict=True):
        _paint_output(axes, fit, start_s)
    for axes in rows:
        axes.locator_params(axis="y", nbins=ticks)
    drawing.align_ylabels(rows)
    return rows


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
