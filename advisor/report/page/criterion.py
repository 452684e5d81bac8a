"""The stop criterion against the number of manoeuvres, rule by rule: the paper's Figure 5 for this flight."""

from collections.abc import Iterator, Mapping, Sequence
from math import sqrt
from typing import Any

from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from advisor.decision.verdict import limit_percent
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, listing, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, log_ticks, picture
from advisor.report.table import Table

_NEWEST = 12
"""Largest number of rows in the table of values. The figures show the whole course."""
_EXPLAINED = (
    "The rules continuous and separate compare the scatter of the newest estimates with a limit (Eq. 12). "
    "The rule information compares errors with the tolerances of the aircraft file (100 %: met). "
    "Line: the criterion as it was told after each manoeuvre. Dashes: the limit. Diamond: the rule says stop."
)


@section("criterion", "Stop criterion")
def criterion(content: Content) -> Iterator[Block]:
    """Yield a figure for each rule, and its values as a table."""
    by_rule = content.analysis["flight_test"]["by_rule"]
    limits = {rule: limit_percent(rule, content.aircraft.campaign) for rule in by_rule}
    if all(value is None for part in by_rule.values() for value in part["history_percent"]):
        yield Paragraph("No rule's criterion has a value yet: too few manoeuvres are accepted.")
        return
    yield Paragraph(_EXPLAINED)
    yield Gallery(tuple(_figure(rule, part, limits[rule]) for rule, part in by_rule.items()))
    progress = content.state.flight_test.by_rule
    yield from listing([f"Rule {rule}, {p.hindsight}." for rule, p in progress.items() if p.hindsight])
    flown = max((len(part["history_percent"]) for part in by_rule.values()), default=0)
    first = max(flown - _NEWEST, 0)
    newest = f", the newest {_NEWEST}" if first else ""
    yield Table(
        "criterion-values",
        f"Criterion in percent after each manoeuvre{newest}; – where it has no value yet.",
        ("flown", *(f"{rule} (limit {limits[rule]:g})" for rule in by_rule)),
        tuple(
            (str(i + 1), *(_value(part["history_percent"], i) for part in by_rule.values()))
            for i in range(first, flown)
        ),
        frozenset(range(len(by_rule) + 1)),
    )  # fmt: skip


def _value(history: Sequence[float | None], i: int) -> str:
    value = history[i] if i < len(history) else None
    return "–" if value is None else f"{value:.1f}"


def _figure(rule: str, part: Mapping[str, Any], limit: float) -> Figure:
    svg = picture(f"criterion-{rule}", 3.2, 2.4, _paint, part, limit)
    stopped = part["stopped_at"]
    said = "does not say stop" if stopped is None else f"says stop after manoeuvre {stopped}"
    return Figure(svg, f"Rule {rule}: {said}.", "third")


def _paint(drawing: Drawing, part: Mapping[str, Any], limit: float) -> None:
    axes = drawing.subplots()
    history = [(i, v) for i, v in enumerate(part["history_percent"], start=1) if v is not None and v > 0.0]
    axes.plot([i for i, _ in history], [v for _, v in history], color=BLUE, marker="o", markersize=3.5)
    axes.axhline(limit, color=BLACK, linestyle="--", linewidth=1.0)
    axes.annotate(
        f"limit {limit:g} %", (0.01, limit), xycoords=("axes fraction", "data"), ha="left", va="bottom"
    )
    stopped = [(i, v) for i, v in history if i == part["stopped_at"]]
    if stopped:
        axes.plot(*stopped[0], marker="D", markersize=9, markerfacecolor="none", markeredgecolor=BLACK)
    low, high = _range([limit, *(v for _, v in history)])
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(FixedLocator(log_ticks(low, high)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.9g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlim(0.5, len(part["history_percent"]) + 0.5)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    axes.set(xlabel="manoeuvres flown", ylabel="criterion [%]")


def _range(values: Sequence[float]) -> tuple[float, float]:
    """Return the ends of the axis: all values with a margin, and at least a factor of ten."""
    low, high = 0.6 * min(values), 1.8 * max(values)
    widen = max(1.0, sqrt(10.0 * low / high))
    return low / widen, high * widen
