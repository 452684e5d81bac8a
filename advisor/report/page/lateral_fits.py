"""Measured and fitted response to aileron and rudder: inputs and outputs over one time axis."""

from collections.abc import Iterator, Sequence
from statistics import fmean

from matplotlib.figure import Figure as Drawing

from advisor.campaign.lateral_state import JudgedLateral, LateralState
from advisor.flight.signals.record import Channel
from advisor.model.lateral import LATERAL
from advisor.oem.estimate import ChannelFit
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph
from advisor.report.page.drawing import picture
from advisor.report.page.fits import paint_input, paint_output
from advisor.words.quantities import CHANNELS

_EXPLAINED = (
    "Grey: measured. Dark dashes: the lateral model fitted to this manoeuvre alone. The aileron is positive "
    "where it rolls to the left, the rudder where it yaws to the left."
)
_MOST = 6
"""Most pictures: the manoeuvres that are explained worst and best are among them."""
Inputs = Sequence[tuple[str, Channel]]


def lateral_fits(state: LateralState) -> Iterator[Block]:
    """Return the fits of the accepted manoeuvres: the worst and the best one, then others as room allows."""
    accepted = [
        (one, one.estimate)
        for one in state.maneuvers
        if one.verdict.accepted and isinstance(one.estimate, LateralEstimate)
    ]
    if not accepted:
        return
    yield Paragraph(_EXPLAINED)
    by_fit = sorted(accepted, key=lambda one: _explained(one[1]))
    kept = [*by_fit[:1], *reversed(by_fit[1:])][:_MOST]
    shown = sorted(kept, key=lambda one: one[0].maneuver.number)
    yield Gallery(tuple(_figure(judged, estimate) for judged, estimate in shown))


def _explained(found: LateralEstimate) -> float:
    """Return the mean share of the motion that the fit explains."""
    return fmean(fit.r2 for fit in found.estimate.fits[0].values())


def _figure(judged: JudgedLateral, found: LateralEstimate) -> Figure:
    maneuver = judged.maneuver
    inputs = [(name, maneuver.channels[name]) for name in LATERAL.inputs if name in maneuver.channels]
    outputs = tuple(found.estimate.fits[0].values())
    svg = picture(
        f"lateral-fit-{maneuver.number}", 3.6, 0.7 + 0.85 * (len(inputs) + len(outputs)), _paint,
        inputs, outputs, maneuver.span.start_s,
    )  # fmt: skip
    told = ", ".join(f"{CHANNELS[fit.name].symbol} R² {fit.r2:.3f}" for fit in outputs)
    return Figure(svg, f"Manoeuvre {maneuver.number}, {maneuver.span.kind}: {told}.", "half")


def _paint(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    rows = drawing.subplots(len(inputs) + len(outputs), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, channel) in zip(rows, inputs, strict=False):
        paint_input(axes, name, channel, start_s)
    for axes, fit in zip(rows[len(inputs) :], outputs, strict=True):
        paint_output(axes, fit, start_s)
    for axes in rows:
        axes.locator_params(axis="y", nbins=4)
    rows[-1].set_xlabel("time since the first step [s]")
    drawing.align_ylabels(list(rows))
