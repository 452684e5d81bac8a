"""Picture of the gap: the worst manoeuvre measured and simulated, its residuals, and small pictures of all
manoeuvres.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from advisor.report.page.blocks import Document
from advisor.report.page.drawing import BLUE, GREY, ORANGE, picture, save
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import CHANNELS

_ACROSS = 2
"""Number of channels side by side in a detailed picture. An overview has all channels in one row."""
_SMALL_ACROSS, _SMALL_ON_A_PHONE = 7, 3
"""Number of small pictures side by side, on a page and on a phone."""
_WIDTH_IN, _ON_A_PHONE_IN = 7.4, 3.8
_OF_A_CHANNEL_IN, _OF_THE_SMALL_IN = 2.4, 1.1
"""Heights of a row of channels and of a row of small pictures, inches."""
_CURVES_IN, _RESIDUALS_IN, _SMALL_IN = 1.25, 0.5, 0.7
"""Heights of the axes for curves, residuals and small pictures, inches."""
_LEFT_IN, _LABEL_IN, _RIGHT_IN = 0.62, 0.42, 0.06
"""Left margin of the axes, distance of the label, and right margin, inches."""
_LEGEND_IN, _TITLE_IN = 0.35, 0.25
"""Height of the legend, and of the numbers above the small pictures, inches."""
_SHOWN_SMALL = ("q", "p")
"""Channels for the small pictures, in order of preference. The first available channel is drawn."""

Trace = Mapping[str, Any]


def caption(document: Document) -> str:
    """Return the description of the picture."""
    return (
        f"Manoeuvre {worst(document)}, the one with the largest gap. Grey: measured. Orange dots: simulated "
        "as given. Dark dashes: with the findings. Below each: measured minus simulated; the band holds 95 % "
        f"of the noise. Last: {CHANNELS[_small(document)].symbol} of every manoeuvre."
    )


def gap_picture(name: str, document: Document, across: int) -> Callable[[], str]:
    """Return the picture for a page, with ``across`` channels side by side."""
    return picture(name, *_size_in(document, across), _paint, document, across)


def _size_in(document: Document, across: int) -> tuple[float, float]:
    """Return width and height of the picture, inches."""
    channels = len({trace["channel"] for trace in document["traces"]})
    small = len({trace["number"] for trace in document["traces"]})
    rows, small_rows = -(-channels // across), -(-small // _small_across(across))
    width = _WIDTH_IN if across > 1 else _ON_A_PHONE_IN
    height = _LEGEND_IN + _OF_A_CHANNEL_IN * rows + _TITLE_IN + _OF_THE_SMALL_IN * small_rows
    return width, height


def _small_across(across: int) -> int:
    """Return the number of small pictures side by side; a phone has one channel per row."""
    return _SMALL_ACROSS if across > 1 else _SMALL_ON_A_PHONE


def _small(document: Document) -> str:
    there = {trace["channel"] for trace in document["traces"]}
    return next(name for name in _SHOWN_SMALL if name in there)


def worst(document: Document) -> int:
    """Return the number of the manoeuvre with the largest gap."""
    return int(max(document["gap"]["by_maneuver"], key=lambda m: m["before"])["number"])


def write_gap_picture(document: Document, path: Path) -> None:
    """Write the picture into a file, in the format of its ending.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    save(path, *_size_in(document, _ACROSS), _paint, document, _ACROSS)


def _paint(drawing: Drawing, document: Document, across: int) -> None:
    """Draw the worst manoeuvre channel by channel, above small pictures of all manoeuvres."""
    # Every axis has a fixed place in inches, because a computed layout would differ in the last digit.
    drawing.set_layout_engine("none")
    number, traces = worst(document), document["traces"]
    large = [trace for trace in traces if trace["number"] == number]
    small = [trace for trace in traces if trace["channel"] == _small(document)]
    width = (float(drawing.get_figwidth()) - _RIGHT_IN) / across
    for k, trace in enumerate(large):
        row, column = divmod(k, across)
        top = _LEGEND_IN + row * _OF_A_CHANNEL_IN
        _paint_channel(drawing, trace, document["gap"]["floor"], (column * width, top, width))
    top = _LEGEND_IN + _OF_A_CHANNEL_IN * -(-len(large) // across) + _TITLE_IN
    small_across = _small_across(across)
    each = (float(drawing.get_figwidth()) - _LEFT_IN - _RIGHT_IN) / small_across
    shared: Axes | None = None
    for k, trace in enumerate(small):
        row, column = divmod(k, small_across)
        place = (_LEFT_IN + column * each, top + row * _OF_THE_SMALL_IN, each - 0.12, _SMALL_IN)
        shared = _paint_small(drawing, trace, place, shared, worst=trace["number"] == number)
        if column:
            drawing.axes[-1].tick_params(labelleft=False)


def _axes(drawing: Drawing, place: tuple[float, float, float, float], shared: Axes | None = None) -> Axes:
    """Return axes at a place: left, top, width and height in inches from the upper left corner."""
    left, top, width, height = place
    across, down = float(drawing.get_figwidth()), float(drawing.get_figheight())
    box = (left / across, 1.0 - (top + height) / down, width / across, height / down)
    return drawing.add_axes(box, sharey=shared)


def _paint_channel(
    drawing: Drawing, trace: Trace, floor: Mapping[str, float], place: tuple[float, float, float]
) -> None:
    """Draw one channel above its residuals; ``place`` is left, top and width in inches."""
    left, top, width = place
    inside = left + _LEFT_IN, width - _LEFT_IN
    curves = _axes(drawing, (inside[0], top, inside[1], _CURVES_IN))
    residuals = _axes(drawing, (inside[0], top + _CURVES_IN + 0.12, inside[1], _RESIDUALS_IN))
    quantity = CHANNELS[trace["channel"]]
    t, measured, before, after = _arrays(trace, quantity.factor)
    curves.plot(t, measured, color=GREY, linewidth=1.8, label="measured")
    curves.plot(t, before, color=ORANGE, linestyle=":", linewidth=1.2, label="simulated as given")
    curves.plot(t, after, color=BLUE, linestyle=(0, (4, 1.5)), linewidth=1.0, label="with the findings")
    curves.set_ylabel(quantity.label)
    curves.tick_params(labelbottom=False)
    half = NORMAL_95 * floor[trace["channel"]] * quantity.factor
    residuals.axhspan(-half, half, facecolor="#dfeaf4", linewidth=0.0)
    residuals.plot(t, measured - before, color=ORANGE, linestyle=":", linewidth=1.0)
    residuals.plot(t, measured - after, color=BLUE, linewidth=0.7)
    residuals.set_xlabel("time [s]")
    residuals.set_ylabel("error")
    for axes in (curves, residuals):
        axes.set_xlim(t[0], t[-1])
        axes.yaxis.set_label_coords(-_LABEL_IN / inside[1], 0.5)
    residuals.locator_params(axis="y", nbins=3)
    if len(drawing.axes) == 2:
        drawing.legend(*curves.get_legend_handles_labels(), loc="upper center", ncols=3)


def _paint_small(
    drawing: Drawing,
    trace: Trace,
    place: tuple[float, float, float, float],
    shared: Axes | None,
    *,
    worst: bool,
) -> Axes:
    """Draw a rate of one manoeuvre, and return the axes whose scale all small pictures share."""
    axes = _axes(drawing, place, shared)
    quantity = CHANNELS[trace["channel"]]
    t, measured, before, after = _arrays(trace, quantity.factor)
    axes.plot(t, measured, color=GREY, linewidth=1.2)
    axes.plot(t, before, color=ORANGE, linestyle=":", linewidth=0.9)
    axes.plot(t, after, color=BLUE, linestyle=(0, (4, 1.5)), linewidth=0.7)
    _bare(axes, f"{trace['number']}{' (above)' if worst else ''}")
    if shared is None:
        axes.set_ylabel(quantity.label)
        axes.yaxis.set_label_coords(-_LABEL_IN / place[2], 0.5)
    return shared or axes


def _bare(axes: Axes, title: str) -> None:
    axes.set_title(title)
    axes.tick_params(labelsize=6)
    axes.locator_params(nbins=3)


def _arrays(trace: Trace, factor: float) -> tuple[Any, Any, Any, Any]:
    """Return the time since the first sample, s, and the measured, original and corrected curves in display
    units, shape (n,) each."""
    t = np.asarray(trace["t"])
    return t - t[0], *(factor * np.asarray(trace[name]) for name in ("measured", "before", "after"))
