"""Roll and yaw: verdict, derivatives, modes, levels, tests of the simulator, and fits."""

from collections.abc import Iterator

from advisor.campaign.state import CampaignState, LateralState
from advisor.decision.axes.lateral_requirements import GROUPS, SOURCE, LateralTest
from advisor.model.axes.lateral import LATERAL
from advisor.model.mil_f_8785c import MANNED
from advisor.report.facts.answers import INDENT, decisions
from advisor.report.facts.estimates import structure_lines, untold
from advisor.report.page.blocks import Block, Content, Paragraph, listing, section
from advisor.report.page.fits import fit_blocks
from advisor.report.page.maneuvers import ANCHORS, HEAD, maneuver_row
from advisor.report.qualities import MODE_NAMES, levels_of, mode_facts, tests_of
from advisor.report.table import Table, joint_table, structure_table
from advisor.words.digits import CLOCK


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
