"""The gap as a picture: the worst manoeuvre measured and simulated, its residuals, all manoeuvres small."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from advisor.report.page.content import Document
from advisor.report.page.drawing import BLUE, GREY, ORANGE, save
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import CHANNELS

_ACROSS = 2
"""Channels side by side."""
_SMALL_ACROSS = 7
"""Small pictures side by side."""
_WIDTH_IN = 7.4
_OF_A_CHANNEL_IN, _OF_THE_SMALL_IN = 2.4, 1.1
"""Heights of a row of channels and of a row of small pictures, inches."""
_SHOWN_SMALL = "q"
"""Channel of the small pictures: the pitch rate moves in every manoeuvre."""

Trace = Mapping[str, Any]


def caption(found: Document) -> str:
    """Return the description of the picture."""
    return (
        f"Manoeuvre {worst(found)}, the one with the largest gap. Grey: measured. Orange dots: the simulator "
        "as given. Dark dashes: with the findings. Below each: measured minus simulated; the band holds 95 % "
        "of the noise. Last: the pitch rate of every manoeuvre."
    )


def size_in(found: Document) -> tuple[float, float]:
    """Return width and height of the picture, inches."""
    channels = len({trace["channel"] for trace in found["traces"]})
    small = len({trace["number"] for trace in found["traces"]})
    rows, small_rows = -(-channels // _ACROSS), -(-small // _SMALL_ACROSS)
    return _WIDTH_IN, _OF_A_CHANNEL_IN * rows + _OF_THE_SMALL_IN * small_rows


def worst(found: Document) -> int:
    """Return the number of the manoeuvre with the largest gap."""
    return int(max(found["gap"]["by_maneuver"], key=lambda one: one["before"])["number"])


def write_gap_picture(found: Document, path: Path) -> None:
    """Write the picture into a file, in the format of its ending.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    save(path, *size_in(found), paint_gap, found)


def paint_gap(drawing: Drawing, found: Document) -> None:
    """Draw the worst manoeuvre channel by channel over all manoeuvres small."""
    number, traces = worst(found), found["traces"]
    large = [trace for trace in traces if trace["number"] == number]
    small = [trace for trace in traces if trace["channel"] == _SHOWN_SMALL]
    rows, small_rows = -(-len(large) // _ACROSS), -(-len(small) // _SMALL_ACROSS)
    heights = [_OF_A_CHANNEL_IN * rows, _OF_THE_SMALL_IN * small_rows]
    above, below = drawing.subfigures(2, 1, squeeze=False, height_ratios=heights)[:, 0]
    _paint_large(above, large, found["gap"]["floor"], rows)
    _paint_small(below, small, number, small_rows)


def _paint_large(part: Any, traces: Sequence[Trace], floor: Mapping[str, float], rows: int) -> None:
    grid = part.subplots(2 * rows, _ACROSS, sharex=True, squeeze=False, height_ratios=[2.2, 1.0] * rows)
    for k, trace in enumerate(traces):
        row, column = divmod(k, _ACROSS)
        quantity = CHANNELS[trace["channel"]]
        curves, residuals = grid[2 * row, column], grid[2 * row + 1, column]
        t, measured, before, after = _arrays(trace, quantity.factor)
        curves.plot(t, measured, color=GREY, linewidth=1.8, label="measured")
        curves.plot(t, before, color=ORANGE, linestyle=":", linewidth=1.2, label="simulator")
        curves.plot(t, after, color=BLUE, linestyle=(0, (4, 1.5)), linewidth=1.0, label="with the findings")
        curves.set_ylabel(quantity.label)
        half = NORMAL_95 * floor[trace["channel"]] * quantity.factor
        residuals.axhspan(-half, half, facecolor="#dfeaf4", linewidth=0.0)
        residuals.plot(t, measured - before, color=ORANGE, linestyle=":", linewidth=1.0)
        residuals.plot(t, measured - after, color=BLUE, linewidth=0.7)
        residuals.set_ylabel(f"error [{quantity.unit}]")
        if 2 * row + 2 >= 2 * rows or k + _ACROSS >= len(traces):
            residuals.set_xlabel("time [s]")
            residuals.tick_params(labelbottom=True)
    for k in range(len(traces), rows * _ACROSS):
        row, column = divmod(k, _ACROSS)
        grid[2 * row, column].set_axis_off()
        grid[2 * row + 1, column].set_axis_off()
    part.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)


def _paint_small(part: Any, traces: Sequence[Trace], number: int, rows: int) -> None:
    grid = part.subplots(rows, min(_SMALL_ACROSS, len(traces)), sharey=True, squeeze=False).ravel()
    factor = CHANNELS[_SHOWN_SMALL].factor
    for axes, trace in zip(grid, traces, strict=False):
        t, measured, before, after = _arrays(trace, factor)
        axes.plot(t, measured, color=GREY, linewidth=1.2)
        axes.plot(t, before, color=ORANGE, linestyle=":", linewidth=0.9)
        axes.plot(t, after, color=BLUE, linestyle=(0, (4, 1.5)), linewidth=0.7)
        _bare(axes, f"{trace['number']}{' (above)' if trace['number'] == number else ''}")
    for axes in grid[len(traces) :]:
        axes.set_axis_off()
    if len(grid):
        grid[0].set_ylabel(CHANNELS[_SHOWN_SMALL].label)


def _bare(axes: Axes, title: str) -> None:
    axes.set_title(title)
    axes.tick_params(labelsize=6)
    axes.locator_params(nbins=3)


def _arrays(trace: Trace, factor: float) -> tuple[Any, Any, Any, Any]:
    """Return time from the first sample, and the three curves in the unit for people; each of shape (n,)."""
    t = np.asarray(trace["t"])
    return t - t[0], *(factor * np.asarray(trace[name]) for name in ("measured", "before", "after"))
