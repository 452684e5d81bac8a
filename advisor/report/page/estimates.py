"""Manoeuvres, estimates with their intervals, and the stop criterion after each manoeuvre."""

from collections.abc import Iterator, Mapping, Sequence
from math import sqrt
from typing import Any

from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.verdict import limit_percent
from advisor.oem.estimate import Estimate
from advisor.report.facts.estimates import (
    EstimatedParameter,
    instrument_facts,
    of_all,
    of_one,
    structure_lines,
)
from advisor.report.page.blocks import Block, Content, Figure, Gallery, Paragraph, Section, listing, section
from advisor.report.page.drawing import BLACK, BLUE, ORANGE, log_ticks, picture
from advisor.report.text import Table, caution_lines, structure_table
from advisor.words.quantities import CLOCK, clock
from advisor.words.quantities import PARAMETERS as QUANTITIES

_MOST_LABELS = 16
"""Largest number of labels in a forest plot. With more manoeuvres only every second manoeuvre has a label, or
fewer.
"""
_NARROW = "±\N{NO-BREAK SPACE}"
"""Separator in cells of a narrow table, with one place for a line break."""
_TALLEST_IN = 3.2
"""Largest height of a forest plot, inches, so that thirty manoeuvres do not fill a page."""


@section("estimates", "Estimates")
def estimates(content: Content) -> Iterator[Block]:
    """Yield a table of the instruments, a forest plot of each parameter, and a table of the manoeuvres."""
    model, prior = content.state.model, content.aircraft.model
    if model is None:
        yield Paragraph("No manoeuvre is accepted, so there is no joint estimate.")
        return
    yield from structure_table(model, "structure")
    yield from listing(structure_lines(model))
    joint = {name: of_all(name, content.state, prior) for name in PARAMETERS}
    if nuisances := instrument_facts(content.state):
        yield Table(
            "instruments",
            f"{nuisances[0][0].source}: nuisance parameters; ± is half the 95 % interval.",
            ("nuisance parameter", "estimate ± 95 %", "aircraft file", "unit"),
            tuple((fact.name, fact.cell, stated, fact.unit) for fact, stated in nuisances), frozenset({1, 2}),
        )  # fmt: skip
    alone = {
        str(judged.maneuver.number): {name: of_one(name, judged, prior) for name in PARAMETERS}
        for judged in content.state.maneuvers
        if judged.verdict.accepted and isinstance(judged.estimate, Estimate)
    }
    drawn = (name for name in PARAMETERS if name not in model.fixed)
    yield Gallery(tuple(_forest(name, alone, joint) for name in drawn))
    yield Table(
        "by-maneuver", "Estimate of each accepted manoeuvre alone, ± half the 95 % interval.",
        ("no.", *(QUANTITIES[name].label for name in PARAMETERS)),
        tuple((n, *(row.cell.replace("± ", _NARROW) for row in rows.values())) for n, rows in alone.items()),
        frozenset(range(len(PARAMETERS) + 1)),
    )  # fmt: skip


def _forest(
    name: str, alone: Mapping[str, Mapping[str, EstimatedParameter]], joint: Mapping[str, EstimatedParameter]
) -> Figure:
    rows = [*((number, parameters[name]) for number, parameters in alone.items()), ("joint", joint[name])]
    drawn = [(label, row) for label, row in rows if row.is_known]
    svg = picture(f"forest-{name}", 2.4, min(0.9 + 0.15 * len(rows), _TALLEST_IN), _paint, joint[name], drawn)
    dashes = "" if joint[name].prior is None else " Dashes: the simulator's value."
    symbol = joint[name].name
    return Figure(
        svg, f"{symbol}: each manoeuvre and the joint estimate with 95 % intervals.{dashes}", "quarter"
    )


def _paint(
    drawing: Drawing, joint: EstimatedParameter, drawn: Sequence[tuple[str, EstimatedParameter]]
) -> None:
    axes = drawing.subplots()
    for at, (label, row) in enumerate(drawn):
        of_all = label == "joint"
        axes.errorbar(
            row.value, at, xerr=row.half,
            fmt="D" if of_all else "o", color=BLACK if of_all else BLUE, markersize=5 if of_all else 3.5,
            linewidth=1.6 if of_all else 0.9, capsize=2,
        )  # fmt: skip
    if joint.prior is not None:
        axes.axvline(joint.prior, color=ORANGE, linestyle="--", linewidth=1.0)
    every = -(-len(drawn) // _MOST_LABELS)
    named = [(at, label) for at, (label, _) in enumerate(drawn) if at % every == 0 or label == "joint"]
    axes.set_yticks([at for at, _ in named], [label for _, label in named])
    axes.invert_yaxis()
    axes.set_xlabel(joint.label)
    axes.locator_params(axis="x", nbins=5)


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
    yield Gallery(tuple(_criterion_figure(rule, part, limits[rule]) for rule, part in by_rule.items()))
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
            (str(i + 1), *(_criterion_value(part["history_percent"], i) for part in by_rule.values()))
            for i in range(first, flown)
        ),
        frozenset(range(len(by_rule) + 1)),
    )  # fmt: skip


def _criterion_value(history: Sequence[float | None], i: int) -> str:
    value = history[i] if i < len(history) else None
    return "–" if value is None else f"{value:.1f}"


def _criterion_figure(rule: str, part: Mapping[str, Any], limit: float) -> Figure:
    svg = picture(f"criterion-{rule}", 3.2, 2.4, _paint_criterion, part, limit)
    stopped = part["stopped_at"]
    said = "does not say stop" if stopped is None else f"says stop after manoeuvre {stopped}"
    return Figure(svg, f"Rule {rule}: {said}.", "third")


def _paint_criterion(drawing: Drawing, part: Mapping[str, Any], limit: float) -> None:
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


_HYPHEN, _SPACE = "\N{NON-BREAKING HYPHEN}", "\N{NO-BREAK SPACE}"
ANCHORS = {"": "maneuver-list", "R": "lateral-maneuvers"}
"""Table that lists a manoeuvre, by the letter before its number: R for roll and yaw."""
HEAD = ("no.", "start", "input", "mode", "verdict", "why")


def maneuvers(content: Content) -> Section:
    """Return a table with a row for each manoeuvre, then cautions that reject no manoeuvre."""
    listed = content.analysis["maneuvers"]
    rows = tuple(maneuver_row(maneuver, several=len(content.names) > 1) for maneuver in listed)
    table = Table(
        ANCHORS[""], f"Every manoeuvre in the order flown; times are {CLOCK}.", HEAD, rows,
        frozenset({0, 1}), anchored=True,
    )  # fmt: skip
    return Section("maneuvers", "Manoeuvres", (table, *listing(caution_lines(content.state.maneuvers))))


def maneuver_row(maneuver: Mapping[str, Any], *, several: bool) -> tuple[str, ...]:
    """Return number, start, input, mode, verdict and sentence of a manoeuvre. With several logs, add the name
    of its log.
    """
    accepted = maneuver["verdict"] == "accepted"
    why = [maneuver["sentence"], *(f"note: {note}" for note in maneuver.get("notes", ()))]
    if maneuver.get("excluded_because") is not None:
        why.append(f"excluded by hand: {maneuver['excluded_because']}")
    if several and "log" in maneuver:
        why.append(f"({maneuver['log']})")
    return (
        str(maneuver["number"]),
        clock(maneuver["start_boot_s"]),
        maneuver["input"].replace("-", _HYPHEN).replace(" ", _SPACE),
        maneuver["mode"],
        f"✓{_SPACE}accepted" if accepted else f"✗{_SPACE}rejected",
        " ".join(why),
    )
