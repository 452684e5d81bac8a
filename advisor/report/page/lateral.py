"""Roll and yaw: verdict, derivatives, modes, levels, tests of the simulator, and fits."""

from collections.abc import Iterator, Mapping

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.campaign.lateral_state import LateralState
from advisor.decision.lateral_levels import GROUPS, SOURCE
from advisor.decision.lateral_qualification import LateralTest
from advisor.model.mil_f_8785c import MANNED
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.report.lateral_qualities import MODES, NAMES, levels_of, modes_told, tests_of
from advisor.report.page.blocks import Block, Paragraph, Section, listing
from advisor.report.page.content import Content
from advisor.report.page.lateral_fits import lateral_fits
from advisor.report.page.maneuvers import HEAD, maneuver_row
from advisor.report.result_rows import parameter_row
from advisor.report.table import Table
from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.vehicle_time import CLOCK


def lateral(content: Content) -> Section | None:
    """Return the section on roll and yaw; None where no aileron and no rudder was flown."""
    state = content.state.lateral
    if state is None or not state.maneuvers:
        return None
    return Section("roll-and-yaw", "Roll and yaw", tuple(_blocks(content, state)))


def _blocks(content: Content, state: LateralState) -> Iterator[Block]:
    yield from lateral_verdict(state)
    rows = tuple(
        maneuver_row(one, several=len(content.names) > 1) for one in content.analysis["lateral"]["maneuvers"]
    )
    yield Table(
        "lateral-maneuvers", f"Inputs of aileron and rudder; times are {CLOCK}.", HEAD, rows,
        frozenset({0, 1}),
    )  # fmt: skip
    if state.model is None:
        yield Paragraph("No manoeuvre is accepted, so there is no joint estimate.")
        return
    yield derivatives(state, state.model, content.aircraft.model, "lateral-joint")
    yield from listing(_untold(state.model))
    yield from _modes(content, state)
    yield from lateral_fits(state)


def lateral_verdict(state: LateralState) -> Iterator[Block]:
    """Yield the sentence on the lateral test, and the next input."""
    verdict = state.flight_test
    mark = "■" if verdict.decision == "stop" else "▶"
    yield Paragraph(f"{mark} {verdict.sentence}", "verdict")
    if verdict.next is not None:
        yield Paragraph(f"Next: {verdict.next.advice.removeprefix('next: ')}.")


def derivatives(state: LateralState, model: LateralEstimate, prior: Mapping[str, float], name: str) -> Table:
    """Return the table of the joint estimate under this name, which is unique on a page."""
    rows = [parameter_row(name, model.estimate, prior) for name in SIDE_PARAMETERS]
    numbers = ", ".join(map(str, state.estimate_from))
    return Table(
        name,
        f"Joint estimate from manoeuvres {numbers} at {model.estimate.airspeed_m_s:.1f} m/s; ± is half the "
        "95 % interval. L and N hold the products of inertia.",
        ("parameter", "estimate ± 95 %", "± 95 % if white", "simulator", "unit"),
        tuple(
            (
                row.quantity.symbol,
                row.cell,
                "–" if row.reason else f"{row.half_if_white:.2g}",
                row.prior_cell,
                row.quantity.unit,
            )
            for row in rows
        ),
        frozenset({1, 2, 3}),
    )


def _untold(model: LateralEstimate) -> list[str]:
    """Return one sentence for each reason why derivatives and modes are not told."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in model.estimate.not_identifiable.items():
        by_reason.setdefault(reason, []).append(parameter_row(name, model.estimate, {}).quantity.symbol)
    told = [f"Not identifiable: {', '.join(names)}; {reason}." for reason, names in by_reason.items()]
    return told + [f"No {NAMES[mode]} mode: {why}." for mode, why in model.modes.left_out.items()]


def _modes(content: Content, state: LateralState) -> Iterator[Block]:
    model = state.model
    told = modes_told(model.modes) if model is not None else {}
    if told:
        yield Table(
            "lateral-modes", "Modes of the joint estimate, ± half the 95 % interval (delta method).",
            ("mode", "value ± 95 %", "unit"),
            tuple(
                (MODES[name][0], with_half(one.value, NORMAL_95 * one.std), MODES[name][1])
                for name, one in told.items()
            ),
            frozenset({1}),
        )  # fmt: skip
    levels = levels_of(state)
    if levels:
        yield Table(
            "lateral-levels", f"Levels by {SOURCE}; the worst mode governs.",
            ("classes", "category", "all modes", *(NAMES[mode] for mode in levels[0].by_mode)),
            tuple(
                (
                    f"{one.group} ({GROUPS[one.group]})",
                    one.category,
                    one.governing.sentence.partition(": ")[2],
                    *(str(level.level) for level in one.by_mode.values()),
                )
                for one in levels
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


def _test(one: LateralTest) -> tuple[str, ...]:
    flown, simulated = (f"{value:.3g}".replace("-", "−") for value in (one.flown, one.simulated))
    holds = "✓" if one.holds else "✗"
    return one.entry, one.name, flown, simulated, f"± {one.limit:.2g}", one.unit, holds
