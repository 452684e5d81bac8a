"""Section about the sim-to-real gap: verdict, size, next steps, causes, and pictures of the worst and of
every manoeuvre.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter

from advisor.aircraft.added_term import SIGNALS
from advisor.gap.result import Unseen, spelled
from advisor.report.facts.gap import LAWS
from advisor.report.facts.reasons import in_percent, is_shown, weighed
from advisor.report.facts.sizes import WORSE, marked, short
from advisor.report.gap_causes import by_reason
from advisor.report.page.blocks import (
    Block,
    Content,
    Document,
    Figure,
    Gallery,
    Paragraph,
    Verbatim,
    listing,
    section,
)
from advisor.report.page.drawing import BLUE, GREY, ORANGE, picture, save
from advisor.report.text import Table
from advisor.words.quantities import CHANNELS, NORMAL_95, Quantity

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
    return picture(name, *_size_in(document, across), _paint_traces, document, across)


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
    save(path, *_size_in(document, _ACROSS), _paint_traces, document, _ACROSS)


def _paint_traces(drawing: Drawing, document: Document, across: int) -> None:
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


_DEFINED = "The gap is the mean square of the simulation's error over that of the noise floor, minus 1: "
_GLANCE = 4
"""Number of channels side by side, so that the picture fits on the first page of A4."""
_OVER = {name: CHANNELS[of] for name, of in SIGNALS.items() if of in CHANNELS}
"""Quantities over which a missing law is drawn, by name."""
_LINEAR = 10.0
"""Largest gap on a linear axis."""


@section("gap", "Sim-to-real gap")
def gap(content: Content) -> Iterator[Block]:
    """Yield the diagnosis; nothing unless requested."""
    if (document := content.gap) is None:
        return
    part = document.get("lateral") or document
    if part["gap"] is None:
        yield Paragraph("The gap could not be diagnosed.")
        yield from listing([f"{p['text']} {p['fix']}" for p in document["problems"]])
        return
    if not document["usable"]:  # else the verdict's section has the answer and the picture
        yield from answer(document)
    size, shrink = part["gap"], part["shrink"]
    if part["parameters_changed"]:
        yield Paragraph("Derivatives that differ from the simulator's; the others agree within 95 %:")
        yield from listing([derivative["text"] for derivative in part["parameters_changed"]])
    grown = size["grown"] and f"{size['grown'][0].upper()}{size['grown'][1:]}"
    said = (size["text"], shrink and shrink["text"], grown)
    yield Paragraph(f"{_DEFINED}{'. '.join(filter(None, said))}.")
    yield Table(
        "gap-channels", f"Gap by channel. {WORSE}: larger than before.",
        ("channel", "before", "after", "noise floor"),
        tuple(_channel(name, size) for name in size["by_channel"]), frozenset({1, 2, 3}),
    )  # fmt: skip
    where = part["where"]
    if part["verdict"] in ("effect", "unknown"):
        yield Paragraph(f"Where: {where['text']}.")
    yield from _law(part.get("missing_law"))
    steps = [(spelled(s["effect"]), s["after"]) for s in part["waterfall"] if s["after"] != size["before"]]
    if steps:
        rows = [("as it is", size["before"]), *((f"+ {name}", after) for name, after in steps)]
        svg = picture("waterfall", 4.4, 0.8 + 0.28 * len(rows), _paint, rows)
        yield Gallery((Figure(svg, "Gap after each effect is added in turn.", "half"),))
    causes = shown_causes(part) if part["verdict"] != "none" else []
    if causes:
        yield Table(
            "causes", "Causes, the most probable first.",
            ("effect", "probability", "values ± 95 %", "gap after", "cannot be told from"),
            tuple(_cause(cause, size["before"]) for cause in causes), frozenset({1, 3}),
        )  # fmt: skip
    if part["why"]:
        reasons = weighed((reason["nats"], reason["text"]) for reason in part["why"])
        title = part["why_heading"]
        yield Table(
            "gap-why",
            f"{title[0].upper()}{title[1:]}. Each reason states the answer's value first, then the rival's "
            f"value.",
            ("nats", "reason"),
            tuple(reasons),
            frozenset({0}),
        )
    yield from listing(
        [
            f"Cannot be seen: {', '.join(names)}; {because}. To see it: {needed}."
            for (because, needed), names in by_reason([Unseen(**u) for u in part["cannot_see"]]).items()
        ]
    )
    yield from listing(list(part["notes"]))
    for number, step in enumerate(part["next"], start=1):
        yield Paragraph(f"{number}. {step['text']}")
        if step["command"]:
            yield Verbatim(step["command"])


def _law(law: Mapping[str, Any] | None) -> Iterator[Block]:
    """Yield the missing force or moment that no candidate explains, as a sentence and as a curve with its
    band.
    """
    if law is None:
        return
    yield Paragraph(law["text"])
    svg = picture("missing-law", 4.4, 2.4, _paint_law, law)
    yield Gallery(
        (Figure(svg, "Missing force or moment over the variable on which it depends most.", "half"),)
    )


def _paint_law(drawing: Drawing, law: Mapping[str, Any]) -> None:
    axes = drawing.subplots()
    quantity = _OVER.get(law["variable"], Quantity("time of flight", "s"))
    x = [quantity.factor * at for at, _ in law["curve"]]
    low, high = zip(*law["band"], strict=True)
    axes.fill_between(x, low, high, color=BLUE, alpha=0.2, linewidth=0)
    axes.plot(x, [y for _, y in law["curve"]], color=BLUE, marker="o", markersize=3)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set_xlabel(quantity.label)
    axes.set_ylabel("missing {} [{}]".format(*LAWS[law["equation"]]))


def glance(document: Document) -> Iterator[Block]:
    """Yield the answer, and the picture of the manoeuvre with the largest gap if there are curves."""
    yield from answer(document)
    part = document.get("lateral") or document
    if part["traces"]:
        wide, narrow = (
            gap_picture("gap-glance", part, _GLANCE),
            gap_picture("gap-narrow", part, 1),
        )
        yield Gallery((Figure(wide, caption(part), narrow=narrow),))


def answer(document: Document) -> Iterator[Block]:
    """Yield the sentence of the answer, its certainty, and its limits."""
    part = document.get("lateral") or document
    axis = "" if part is document else "Roll and yaw. "
    yield Paragraph(f"{axis}{part['title']}: {part['sentence']}", "verdict")
    if part["how_sure"]:
        yield Paragraph(part["how_sure"])
    yield from listing(list(part["limits"]))


def shown_causes(document: Document) -> list[Mapping[str, Any]]:
    """Return the causes that get a table row. They are in the improved simulator, or their printed
    probability is above 0 %.
    """
    return [cause for cause in document["causes"] if cause["in_model"] or is_shown(cause["probability"])]


def _channel(name: str, size: Mapping[str, Any]) -> tuple[str, ...]:
    after, quantity = size["by_channel_after"].get(name), CHANNELS[name]
    floor = f"{size['floor'][name] * quantity.factor:.2g} {quantity.unit}"
    before = size["by_channel"][name]
    return quantity.symbol, short(before), "–" if after is None else marked(after, before), floor


def _cause(cause: Mapping[str, Any], before: float) -> tuple[str, ...]:
    after = cause["gap_after"]
    return (
        spelled(cause.get("name", cause["effect"])),
        in_percent(cause["probability"]),
        cause["text"],
        "–" if after is None else marked(after, before),
        ", ".join(map(spelled, cause["cannot_be_told_from"])) or "–",
    )


def _paint(drawing: Drawing, rows: list[tuple[str, float]]) -> None:
    axes = drawing.subplots()
    axes.set_axisbelow(True)
    axes.barh(range(len(rows)), [max(value, 0.0) for _, value in rows], color=BLUE, height=0.6)
    axes.set_yticks(range(len(rows)), [name for name, _ in rows])
    for row, (_, value) in enumerate(rows):
        axes.annotate(f" {short(value)}", (max(value, 0.0), row), va="center")
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    largest = max(value for _, value in rows)
    if largest > _LINEAR:
        axes.set_xscale("symlog", linthresh=1.0)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlim(0.0, largest * (3.0 if largest > _LINEAR else 1.15))
    axes.set_xlabel("gap [times the noise floor's power]")
