"""Estimates with their intervals: joint estimate with the file's model, and each manoeuvre."""

from collections.abc import Iterator, Mapping, Sequence

from matplotlib.figure import Figure as Drawing

from advisor.aircraft.reference import PARAMETERS
from advisor.oem.estimate import Estimate
from advisor.report.facts.estimates import (
    EstimatedParameter,
    instrument_facts,
    of_all,
    of_one,
    structure_lines,
)
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, listing, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, ORANGE, picture
from advisor.report.result_rows import structure_table
from advisor.report.table import Table
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
