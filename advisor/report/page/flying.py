"""Flying qualities and coefficients, with their air and conventions."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Gallery, Paragraph, Section, listing
from advisor.report.page.content import Content, Document
from advisor.report.page.flying_chart import flying_chart
from advisor.report.qualities import NAMES
from advisor.report.table import Table
from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95


def flying(content: Content) -> Section:
    """Return the section on flying qualities: numbers, levels, coefficients, air."""
    return Section("flying-qualities", "Flying qualities", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    found = content.analysis["flying_qualities"]
    if found is None:
        yield Paragraph("No manoeuvre is accepted, so there are no flying qualities.")
        return
    present = {name: found[name] for name in NAMES if name in found}
    yield Table(
        "qualities", "Flying qualities of the joint estimate, ± half the 95 % interval (delta method).",
        ("quantity", "value ± 95 %", "unit"),
        tuple((NAMES[name], _with_interval(q), q["unit"]) for name, q in present.items()),
        frozenset({1}),
    )  # fmt: skip
    yield from listing([f"{NAMES[name]} is not given: {why}." for name, why in found["left_out"].items()])
    if found["levels"]:
        if chart := flying_chart(found):
            yield Gallery((chart,))
        yield Table(
            "levels", f"Levels by {found['source']}.", ("category", "flight phases", "level"),
            tuple((c, one["phases"], one["text"].partition(": ")[2]) for c, one in found["levels"].items()),
        )  # fmt: skip
        yield Paragraph(found["caution"], "note")
    coefficients = content.analysis["coefficients"]
    if coefficients:
        yield Table(
            "coefficients", f"Coefficients {found['convention']}. Drag's part in the lift is neglected.",
            ("coefficient", "value ± 95 %"),
            tuple((name, _with_interval(one)) for name, one in coefficients.items()), frozenset({1}),
        )  # fmt: skip
    air = found["air"]
    logged, true = air["airspeed_m_s"], air["true_airspeed_m_s"]
    speeds = "" if logged is None else f" Logged air speed {logged:.1f} m/s, true air speed {true:.1f} m/s."
    yield Paragraph(
        f"{air['text'][0].upper()}{air['text'][1:]}.{speeds} The intervals hold the errors of the estimate, "
        "not those of air speed, density, mass and geometry.",
        "note",
    )


def _with_interval(one: Document) -> str:
    return with_half(one["value"], NORMAL_95 * one["std"])
