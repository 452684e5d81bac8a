"""The sim-to-real gap, where it was asked for: verdict, size, steps, causes."""

from collections.abc import Iterator, Mapping
from typing import Any

from matplotlib.figure import Figure as Drawing

from advisor.gap.result import spelled
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section, Table, listing
from advisor.report.page.content import Content, Document
from advisor.report.page.drawing import BLUE, draw


def gap(content: Content) -> Section | None:
    """The diagnosis; None where it was not asked for."""
    if content.gap is None:
        return None
    return Section("gap", "Sim-to-real gap", tuple(_blocks(content.gap)))


def _blocks(found: Document) -> Iterator[Block]:
    if not found["usable"]:
        yield Paragraph("The gap could not be diagnosed.")
        yield from listing([f"{p['text']} {p['fix']}" for p in found["problems"]])
        return
    yield Paragraph(found["sentence"], "verdict")
    size, shrink = found["gap"], found["shrink"]
    yield Paragraph(
        "Gap: mean square of the simulator's error over the noise floor's, minus 1. "
        f"Before {size['before']:.3g}, after {size['after']:.3g}." + _shrink(shrink)
    )
    yield Table(
        "gap-channels", "Gap by channel.", ("channel", "before", "after", "noise floor (SI)"),
        tuple(
            (c, f"{v:.3g}", f"{size['by_channel_after'].get(c, float('nan')):.3g}", f"{size['floor'][c]:.3g}")
            for c, v in size["by_channel"].items()
        ),
        frozenset({1, 2, 3}),
    )  # fmt: skip
    if found["waterfall"]:
        steps = [
            ("as it is", size["before"]),
            *((f"+ {spelled(s['effect'])}", s["after"]) for s in found["waterfall"]),
        ]
        svg = draw("waterfall", 5.0, 0.7 + 0.28 * len(steps), lambda d: _paint(d, steps))
        yield Gallery((Figure(svg, "Gap left as effects are added, one after another."),))
    if found["causes"]:
        yield Table(
            "causes", "Causes, the most probable first.",
            ("effect", "probability", "values ± 95 %", "gap after", "cannot be told from"),
            tuple(_cause(cause) for cause in found["causes"]), frozenset({1, 3}),
        )  # fmt: skip
    yield from listing(
        [f"Cannot be seen: {spelled(u['effect'])}, {u['because']}." for u in found["cannot_see"]]
    )
    yield from listing(list(found["notes"]))


def _shrink(shrink: Mapping[str, Any] | None) -> str:
    if shrink is None:
        return ""
    low, high = shrink["ci95_percent"]
    held_out = ", ".join(map(str, shrink["holdout"]))
    return (
        f" {shrink['percent']:.1f} % less (95 %: {low:.1f} to {high:.1f}) on held-out manoeuvres {held_out}."
    )


def _cause(cause: Mapping[str, Any]) -> tuple[str, ...]:
    values = ", ".join(
        f"{n} {v['value']:.4g} ± {1.96 * v['std']:.2g}" for n, v in cause["parameters"].items()
    )
    after = cause["gap_after"]
    return (
        spelled(cause["effect"]),
        f"{cause['probability']:.2f}",
        values,
        "–" if after is None else f"{after:.3g}",
        ", ".join(map(spelled, cause["cannot_be_told_from"])) or "–",
    )


def _paint(drawing: Drawing, steps: list[tuple[str, float]]) -> None:
    axes = drawing.subplots()
    axes.barh(range(len(steps)), [max(value, 0.0) for _, value in steps], color=BLUE, height=0.6)
    axes.set_yticks(range(len(steps)), [name for name, _ in steps])
    for row, (_, value) in enumerate(steps):
        axes.annotate(f" {value:.3g}", (max(value, 0.0), row), va="center")
    axes.invert_yaxis()
    axes.set_xscale("symlog", linthresh=1.0)
    axes.set_xlabel("gap, times the noise floor's power")
