"""Section about the sim-to-real gap: verdict, size, next steps and causes."""

from collections.abc import Iterator, Mapping
from typing import Any

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
from advisor.report.page.drawing import BLUE, GREY, picture
from advisor.report.page.gap_picture import caption, gap_picture
from advisor.report.table import Table
from advisor.words.quantities import CHANNELS, Quantity

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
