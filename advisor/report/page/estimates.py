"""The estimates with their intervals: joint estimate against the file's model, and each manoeuvre."""

from collections.abc import Iterator, Mapping
from typing import Any

from matplotlib.figure import Figure as Drawing

from advisor.aircraft.aircraft import PARAMETERS
from advisor.report.digits import decimals_for, signed, with_half
from advisor.report.document import NORMAL_95
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section, Table
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, ORANGE, picture
from advisor.report.text import SYMBOLS, UNITS, shown


def estimates(content: Content) -> Section:
    """Return the joint estimate as a table, a forest plot for each parameter, then the table of
    manoeuvres."""
    return Section("estimates", "Estimates", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    model, prior = content.analysis["model"], content.aircraft.model
    if model is None:
        yield Paragraph("No manoeuvre is accepted, so there is no joint estimate.")
        return
    numbers = ", ".join(map(str, content.analysis["estimate_from"]))
    speed = model["reference_airspeed_m_s"]
    at = "" if speed is None else f" at {speed:.1f} m/s"
    yield Table(
        "joint", f"Joint estimate from manoeuvres {numbers}{at}; ± is half the 95 % interval.",
        ("parameter", "estimate ± 95 %", "± 95 % if white", "file's model", "unit"),
        tuple(_joint(name, model[name], prior.get(name)) for name in PARAMETERS), frozenset({1, 2, 3}),
    )  # fmt: skip
    accepted = [m for m in content.analysis["maneuvers"] if m["verdict"] == "accepted" and m["estimates"]]
    yield Gallery(tuple(_forest(name, accepted, model[name], prior.get(name)) for name in PARAMETERS))
    yield Table(
        "by-maneuver", "Estimate of each accepted manoeuvre alone, ± half the 95 % interval.",
        ("no.", *(f"{SYMBOLS[name]} [{UNITS[name]}]" for name in PARAMETERS)),
        tuple(map(_alone, accepted)),
        frozenset(range(len(PARAMETERS) + 1)),
    )  # fmt: skip


def _joint(name: str, entry: Mapping[str, Any], prior: float | None) -> tuple[str, ...]:
    known = "–"
    if prior is not None:
        half = 0.0 if entry["std"] is None else shown(name, NORMAL_95 * entry["std"])
        known = signed(shown(name, prior), decimals_for(half))
    if entry["value"] is None:
        return SYMBOLS[name], f"– ({entry['reason']})", "–", known, UNITS[name]
    white = shown(name, NORMAL_95 * entry["std_cr"])
    return SYMBOLS[name], _cell(name, entry), f"{white:.2g}", known, UNITS[name]


def _cell(name: str, entry: Mapping[str, Any]) -> str:
    if entry["value"] is None or entry["std"] is None:
        return "–"
    return with_half(shown(name, entry["value"]), shown(name, NORMAL_95 * entry["std"]))


def _alone(maneuver: Mapping[str, Any]) -> tuple[str, ...]:
    cells = (_narrow(_cell(name, maneuver["estimates"][name])) for name in PARAMETERS)
    return str(maneuver["number"]), *cells


def _narrow(cell: str) -> str:
    """Return the cell with one place for a line break, before the interval."""
    return cell.replace("± ", "±\N{NO-BREAK SPACE}")


def _forest(
    name: str, accepted: list[Mapping[str, Any]], joint: Mapping[str, Any], prior: float | None
) -> Figure:
    rows = [(str(m["number"]), m["estimates"][name]) for m in accepted] + [("joint", joint)]
    known = [(label, one) for label, one in rows if one["value"] is not None and one["std"] is not None]
    svg = picture(f"forest-{name}", 2.4, 0.9 + 0.15 * len(rows), _paint, name, known, prior)
    told = "" if prior is None else " Dashes: the file's model."
    return Figure(
        svg, f"{SYMBOLS[name]}: each manoeuvre and the joint estimate with 95 % intervals.{told}", "quarter"
    )


def _paint(
    drawing: Drawing, name: str, known: list[tuple[str, Mapping[str, Any]]], prior: float | None
) -> None:
    axes = drawing.subplots()
    for row, (label, one) in enumerate(known):
        joint = label == "joint"
        axes.errorbar(
            shown(name, one["value"]), row, xerr=shown(name, NORMAL_95 * one["std"]),
            fmt="D" if joint else "o", color=BLACK if joint else BLUE, markersize=5 if joint else 3.5,
            linewidth=1.6 if joint else 0.9, capsize=2,
        )  # fmt: skip
    if prior is not None:
        axes.axvline(shown(name, prior), color=ORANGE, linestyle="--", linewidth=1.0)
    axes.set_yticks(range(len(known)), [label for label, _ in known])
    axes.invert_yaxis()
    axes.set_xlabel(f"{SYMBOLS[name]} [{UNITS[name]}]")
    axes.locator_params(axis="x", nbins=5)
