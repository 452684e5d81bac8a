"""The sim-to-real gap, where requested: verdict, size, steps, causes."""

from collections.abc import Iterator, Mapping
from math import nan
from typing import Any

from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter

from advisor.gap.result import Value, spelled
from advisor.gap.verdict.text import place
from advisor.report.gap_reasons import alternatives_of, heading_of, how_sure, in_percent, is_shown, weighed
from advisor.report.gap_sizes import WORSE, marked, short, sizes_of
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section, Verbatim, listing
from advisor.report.page.content import Content, Document
from advisor.report.page.drawing import BLUE, picture
from advisor.report.page.gap_picture import caption, gap_picture
from advisor.report.table import Table
from advisor.words.digits import decimals_for, signed, with_half
from advisor.words.quantities import CHANNELS, PARAMETERS

_LINEAR = 10.0
"""Largest gap on a linear axis."""


def gap(content: Content) -> Section | None:
    """Return the diagnosis; None where none was requested."""
    if content.gap is None:
        return None
    return Section("gap", "Sim-to-real gap", tuple(_blocks(content.gap)))


def _blocks(found: Document) -> Iterator[Block]:
    if found["gap"] is None:
        yield Paragraph("The gap could not be diagnosed.")
        yield from listing([f"{p['text']} {p['fix']}" for p in found["problems"]])
        return
    yield from answer(found)
    size, shrink = found["gap"], found["shrink"]
    if found["traces"]:
        close, phone = gap_picture("gap-picture", found), gap_picture("gap-phone", found, across=1)
        yield Gallery((Figure(close, caption(found), narrow=phone, printed=False),))
    if found["parameters_changed"]:
        yield Table(
            "gap-parameters", "Derivatives that differ from the simulator's; the others agree within 95 %.",
            ("derivative", "simulator", "flight ± 95 %", "change", "unit"),
            tuple(map(_changed, found["parameters_changed"])), frozenset({1, 2, 3}),
        )  # fmt: skip
    yield Paragraph(_size(size, untested=found["verdict"] is None) + _shrink(shrink))
    yield Table(
        "gap-channels", f"Gap by channel. {WORSE}: larger than before.",
        ("channel", "before", "after", "noise floor"),
        tuple(_channel(name, size) for name in size["by_channel"]), frozenset({1, 2, 3}),
    )  # fmt: skip
    where = found["where"]
    if found["verdict"] in ("effect", "unknown"):
        yield Paragraph(f"Where: {place(where['block'])}, {100.0 * where['share']:.0f} % of the gap.")
    steps = [(spelled(s["effect"]), s["after"]) for s in found["waterfall"] if s["after"] != size["before"]]
    if steps:
        rows = [("as it is", size["before"]), *((f"+ {name}", after) for name, after in steps)]
        svg = picture("waterfall", 4.4, 0.8 + 0.28 * len(rows), _paint, rows)
        yield Gallery((Figure(svg, "Gap left as effects are added, one after another.", "half"),))
    causes = shown_causes(found)
    if causes:
        yield Table(
            "causes", "Causes, the most probable first.",
            ("effect", "probability", "values ± 95 %", "gap after", "cannot be told from"),
            tuple(_cause(cause, size["before"]) for cause in causes), frozenset({1, 3}),
        )  # fmt: skip
    if found["why"]:
        reasons = weighed((one["nats"], one["text"]) for one in found["why"])
        title = heading_of(found)
        yield Table(
            "gap-why",
            f"{title[0].upper()}{title[1:]}. First the value of the answer, then that of the rival.",
            ("nats", "reason"),
            tuple(reasons),
            frozenset({0}),
        )
    yield from listing(
        [
            f"Cannot be seen: {spelled(u['effect'])}, {u['because']}. To see it: {u['would_need']}."
            for u in found["cannot_see"]
        ]
    )
    yield from listing(list(found["notes"]))
    for number, step in enumerate(found["next"], start=1):
        yield Paragraph(f"{number}. {step['text']}")
        if step["command"]:
            yield Verbatim(step["command"])


def answer(found: Document) -> Iterator[Block]:
    """Yield the sentence, how sure it is, and what limits it."""
    yield Paragraph(f"{found['title']}: {found['sentence']}", "verdict")
    if sure := how_sure(alternatives_of(found)):
        yield Paragraph(sure)
    yield from listing(list(found["limits"]))


def shown_causes(found: Document) -> list[Mapping[str, Any]]:
    """Return the causes with a row: part of the improved simulator, or of a probability above 0 %."""
    return [cause for cause in found["causes"] if cause["in_model"] or is_shown(cause["probability"])]


def _changed(one: Mapping[str, Any]) -> tuple[str, ...]:
    quantity = PARAMETERS[one["derivative"]]
    low, high = one["ci95"]
    half, found = 0.5 * (high - low) * quantity.factor, one["found"] * quantity.factor
    share = "–" if one["percent"] is None else f"{signed(one['percent'], 0)} %"
    given = signed(one["simulator"] * quantity.factor, decimals_for(half))
    return quantity.symbol, given, with_half(found, half), share, quantity.unit


def _size(size: Mapping[str, Any], untested: bool) -> str:
    what = "mean square of the simulator's error over the noise floor's, minus 1"
    if untested:
        return f"The fitted model leaves {short(size['after'])} ({what})."
    return f"Gap ({what}): before {short(size['before'])}, after {short(size['after'])}."


def _channel(name: str, size: Mapping[str, Any]) -> tuple[str, ...]:
    after, quantity = size["by_channel_after"].get(name), CHANNELS[name]
    floor = f"{size['floor'][name] * quantity.factor:.2g} {quantity.unit}"
    before = size["by_channel"][name]
    return quantity.symbol, short(before), "–" if after is None else marked(after, before), floor


def _shrink(shrink: Mapping[str, Any] | None) -> str:
    if shrink is None:
        return ""
    low, high = shrink["ci95_percent"]
    interval = "" if low is None or high is None else f" (95 %: {low:.1f} to {high:.1f})"
    held_out = ", ".join(map(str, shrink["holdout"]))
    return f" {shrink['percent']:.1f} % less{interval} on held-out manoeuvres {held_out}."


def _cause(cause: Mapping[str, Any], before: float) -> tuple[str, ...]:
    known = {name: one for name, one in cause["parameters"].items() if one["value"] is not None}
    sizes = {name: Value(one["value"], _or_nan(one["std"])) for name, one in known.items()}
    after = cause["gap_after"]
    return (
        spelled(cause["effect"]),
        in_percent(cause["probability"]),
        ", ".join(sizes_of(sizes)),
        "–" if after is None else marked(after, before),
        ", ".join(map(spelled, cause["cannot_be_told_from"])) or "–",
    )


def _or_nan(value: float | None) -> float:
    return nan if value is None else value


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
