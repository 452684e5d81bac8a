"""Flying qualities of pitch, with the level charts of MIL-F-8785C, and the section on roll and yaw."""

from collections.abc import Callable, Iterator, Mapping
from math import inf
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from advisor.campaign.state import CampaignState, LateralState
from advisor.decision.axes.lateral_requirements import GROUPS, SOURCE, LateralTest
from advisor.model.axes.lateral import LATERAL
from advisor.model.mil_f_8785c import CATEGORIES, LIMITS, MANNED, Range, ShortPeriodLimits
from advisor.process.arrays import FloatArray
from advisor.report.facts.answers import INDENT, decisions
from advisor.report.facts.estimates import fact_of, structure_lines, untold
from advisor.report.page.blocks import Block, Content, Document, Figure, Gallery, Paragraph, listing, section
from advisor.report.page.drawing import BLACK, BLUE, GREY, log_ticks, picture
from advisor.report.page.estimates import ANCHORS, HEAD, maneuver_row
from advisor.report.page.fits import fit_blocks
from advisor.report.qualities import MODE_NAMES, NAMES, levels_of, mode_facts, tests_of
from advisor.report.text import Table, joint_table, structure_table
from advisor.words.quantities import CLOCK, PAIR_95


@section("flying-qualities", "Flying qualities")
def flying(content: Content) -> Iterator[Block]:
    """Yield the flying qualities: numbers, levels, coefficients, air."""
    document = content.analysis["flying_qualities"]
    if document is None:
        yield Paragraph("No manoeuvre is accepted, so there are no flying qualities.")
        return
    present = {name: document[name] for name in NAMES if name in document}
    yield Table(
        "qualities", "Flying qualities of the joint estimate, ± half the 95 % interval (delta method).",
        ("quantity", "value ± 95 %", "unit"),
        tuple((NAMES[name], _cell(NAMES[name], q), q["unit"]) for name, q in present.items()),
        frozenset({1}),
    )  # fmt: skip
    yield from listing([f"{NAMES[name]} is not given: {why}." for name, why in document["left_out"].items()])
    if document["levels"]:
        if chart := flying_chart(document):
            yield Gallery((chart,))
        yield Table(
            "levels", f"Levels by {document['source']}.", ("category", "flight phases", "level"),
            tuple((c, x["phases"], x["text"].partition(": ")[2]) for c, x in document["levels"].items()),
        )  # fmt: skip
        yield Paragraph(document["caution"], "note")
    coefficients = content.analysis["coefficients"]
    if coefficients:
        yield Table(
            "coefficients", f"Coefficients {document['convention']}. Drag's part in the lift is neglected.",
            ("coefficient", "value ± 95 %"),
            tuple((name, _cell(name, estimate)) for name, estimate in coefficients.items()), frozenset({1}),
        )  # fmt: skip
    air = document["air"]
    logged, true = air["airspeed_m_s"], air["true_airspeed_m_s"]
    speeds = "" if logged is None else f" Air speed {logged:.1f} m/s as read, {true:.1f} m/s true."
    yield Paragraph(
        f"{air['text'][0].upper()}{air['text'][1:]}.{speeds} The intervals hold the errors of the estimate, "
        "not those of air speed, density, mass and geometry.",
        "note",
    )


def _cell(name: str, estimate: Document) -> str:
    return fact_of(name, "Joint estimate", estimate["value"], estimate["std"]).cell


_FILLS = ("#c6dbef", "#e1ecf7", "#f3f7fb")
"""Colours of Levels 1 to 3, the darkest for Level 1."""
_LINES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Styles of the bounds of Levels 1 to 3, so that a print without colour shows them."""
_ROOM = 2.0
"""Least ratio between the ends of the axes and the short period's values, so that nearby bounds
are visible.
"""
_WIDTH_IN, _HEIGHT_IN = 7.4, 2.6
_PHONE_IN, _OF_A_PANEL_IN = 3.8, 2.4


def flying_chart(document: Document) -> Figure | None:
    """Return the chart; None if frequency, n/α, damping or their covariance are missing."""
    if document["correlation"] is None or "damping" not in document:
        return None
    return Figure(
        _drawn("levels-chart", document, across=True),
        "Natural frequency against acceleration sensitivity n/α in the categories A, B and C, and damping. "
        "Cross and ellipse: the estimate with its joint 95 % region; bar: the 95 % interval of the damping. "
        "Solid, dashed and dotted lines bound the Levels 1, 2 and 3; the darkest field is Level 1.",
        narrow=_drawn("levels-phone", document, across=False),
    )


def _drawn(name: str, document: Document, *, across: bool) -> Callable[[], str]:
    """Return a function that draws the chart with its panels in a row, or stacked for a phone."""
    panels = len(CATEGORIES) + 1
    size = (_WIDTH_IN, _HEIGHT_IN) if across else (_PHONE_IN, _OF_A_PANEL_IN * panels)
    return picture(name, *size, _paint, document, across)


def ellipse(document: Document) -> tuple[FloatArray, FloatArray]:
    """Return n/α and ω_n along the joint 95 % region, each of shape (n,).

    The region is an ellipse in the logarithms, so both values stay positive.
    """
    load, frequency = document["n_alpha"], document["natural_frequency"]
    across, up = (quality["std"] / quality["value"] for quality in (load, frequency))
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    first, second = PAIR_95 * np.cos(angle), PAIR_95 * np.sin(angle)
    rho = document["correlation"]
    along = rho * first + (1.0 - rho**2) ** 0.5 * second
    return load["value"] * np.exp(across * first), frequency["value"] * np.exp(up * along)


def _paint(drawing: Drawing, document: Document, across: bool) -> None:
    panels = len(CATEGORIES) + 1
    shape = (1, panels) if across else (panels, 1)
    widths = [1.0] * len(CATEGORIES) + [0.8] if across else None
    every = np.ravel(drawing.subplots(*shape, width_ratios=widths))
    region = ellipse(document)
    for axes, (category, limits) in zip(every, LIMITS.items(), strict=False):
        _paint_frequency(axes, limits, document, region)
        axes.set_title(f"Category {category}")
        axes.set_xlabel("n/α [g/rad]")
        if not across or category == "A":
            axes.set_ylabel("ω_n [rad/s]")
    _paint_damping(every[-1], document["damping"])
    handles = [Line2D([], [], color=BLACK, linestyle=line, linewidth=0.8) for line in _LINES]
    drawing.legend(handles, [f"Level {level}" for level in (1, 2, 3)], loc="outside upper center", ncols=3)


def _paint_frequency(
    axes: Axes,
    limits: tuple[ShortPeriodLimits, ...],
    document: Document,
    region: tuple[FloatArray, FloatArray],
) -> None:
    """Draw the levels of one category, the estimate and its region, on logarithmic axes."""
    load, frequency = document["n_alpha"]["value"], document["natural_frequency"]["value"]
    ends_x, ends_y = (
        (min(centre / _ROOM, float(curve.min())), max(centre * _ROOM, float(curve.max())))
        for centre, curve in ((load, region[0]), (frequency, region[1]))
    )
    for limit, fill, line in reversed(list(zip(limits, _FILLS, _LINES, strict=True))):
        x = np.geomspace(max(ends_x[0], limit.load[0]), max(ends_x[1], limit.load[0]), 60)
        low = np.maximum(np.sqrt(limit.cap[0] * x), limit.frequency[0])
        high = np.full_like(x, ends_y[1]) if limit.cap[1] == inf else np.sqrt(limit.cap[1] * x)
        axes.fill_between(x, low, np.maximum(low, high), facecolor=fill, linewidth=0.0)
        bounds = [low] if limit.cap[1] == inf else [low, high]
        for bound in bounds:
            axes.plot(x, bound, color=BLACK, linestyle=line, linewidth=0.8)
        if limit.load[0] > ends_x[0]:
            axes.plot([limit.load[0]] * 2, [low[0], high[0]], color=BLACK, linestyle=line, linewidth=0.8)
    axes.plot(*region, color=BLUE, linewidth=1.2)
    axes.plot(load, frequency, marker="+", color=BLUE, markersize=7, markeredgewidth=1.4)
    axes.set(xscale="log", yscale="log", xlim=ends_x, ylim=ends_y)
    for axis, ends in ((axes.xaxis, ends_x), (axes.yaxis, ends_y)):
        axis.set_major_locator(FixedLocator(log_ticks(*ends)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())


def _paint_damping(axes: Axes, damping: Mapping[str, Any]) -> None:
    """Draw the levels of damping in each category as bars, and the estimate with its interval across them."""
    low, high = damping["ci95"]
    top = max(2.2, 1.1 * high)
    for column, limits in enumerate(LIMITS.values()):
        for limit, fill, line in reversed(list(zip(limits, _FILLS, _LINES, strict=True))):
            inside: Range = (limit.damping[0], min(limit.damping[1], top))
            axes.fill_between([column - 0.4, column + 0.4], *inside, facecolor=fill, linewidth=0.0)
            for bound in limit.damping:
                axes.plot(
                    [column - 0.4, column + 0.4], [bound] * 2, color=BLACK, linestyle=line, linewidth=0.8
                )
    axes.axhspan(low, high, facecolor=BLUE, alpha=0.3, linewidth=0.0)
    axes.axhline(damping["value"], color=BLUE, linewidth=1.2)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    axes.set_xticks(range(len(LIMITS)), list(LIMITS))
    axes.set(ylim=(min(0.0, 1.1 * low), top), ylabel="ζ [1]", xlabel="category", title="Damping")
    axes.grid(visible=False, axis="x")


@section("roll-and-yaw", "Roll and yaw")
def lateral(content: Content) -> Iterator[Block]:
    """Yield the section on roll and yaw; nothing if neither aileron nor rudder was flown."""
    state = content.state.lateral
    if state is None or not state.maneuvers:
        return
    yield from decided(content.state, pitch=False)
    rows = tuple(
        maneuver_row(m, several=len(content.names) > 1) for m in content.analysis["lateral"]["maneuvers"]
    )
    yield Table(
        ANCHORS["R"], f"Inputs of aileron and rudder; times are {CLOCK}.", HEAD, rows,
        frozenset({0, 1}), anchored=True,
    )  # fmt: skip
    joint = joint_table(state, content.aircraft.model, "lateral-joint")
    if state.model is None or joint is None:
        yield Paragraph("No manoeuvre is accepted, so there is no joint estimate.")
        return
    yield joint
    yield from structure_table(state.model, "lateral-structure")
    yield from listing([*structure_lines(state.model), *untold(state.model)])
    yield from _modes(content, state)
    yield from fit_blocks(state.maneuvers, LATERAL.inputs, "lateral model", "lateral-fit")


def decided(state: CampaignState, *, pitch: bool = True) -> Iterator[Block]:
    """Yield stop or continue of each axis, and the next input."""
    for line in decisions(state, pitch=pitch):
        yield Paragraph(line.strip(), "plain" if line.startswith(INDENT) else "verdict")


def _modes(content: Content, state: LateralState) -> Iterator[Block]:
    if modes := mode_facts(state):
        yield Table(
            "lateral-modes", "Modes of the joint estimate, ± half the 95 % interval (delta method).",
            ("mode", "value ± 95 %", "unit"),
            tuple((mode.name, mode.cell, mode.unit) for mode in modes),
            frozenset({1}),
        )  # fmt: skip
    levels = levels_of(state)
    if levels:
        yield Table(
            "lateral-levels", f"Levels by {SOURCE}; the worst mode governs.",
            ("classes", "category", "all modes", *(MODE_NAMES[mode] for mode in levels[0].by_mode)),
            tuple(
                (
                    f"{rated.group} ({GROUPS[rated.group]})",
                    rated.category,
                    rated.governing.sentence.partition(": ")[2],
                    *(str(level.level) for level in rated.by_mode.values()),
                )
                for rated in levels
            ),
        )  # fmt: skip
        yield Paragraph(MANNED, "note")
    tests = tests_of(state, content.aircraft)
    if tests:
        yield Table(
            "lateral-qualification",
            "The aircraft file's model against the flight, by 14 CFR Part 60, Appendix A, Table A2A.",
            ("test", "quantity", "flown", "simulator", "limit", "unit", "holds"),
            tuple(map(_test, tests)),
            frozenset({2, 3, 4}),
        )


def _test(test: LateralTest) -> tuple[str, ...]:
    flown, simulated = (f"{value:.3g}".replace("-", "−") for value in (test.flown, test.simulated))
    holds = "✓" if test.holds else "✗"
    return test.entry, test.name, flown, simulated, f"± {test.limit:.2g}", test.unit, holds
