"""Roll and yaw: verdict, derivatives, modes, levels, tests of the simulator, and fits."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean

from matplotlib.figure import Figure as Drawing

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.campaign.state import JudgedLateral, LateralState
from advisor.decision.lateral_levels import GROUPS, SOURCE
from advisor.decision.lateral_qualification import LateralTest
from advisor.flight.signals.record import Channel
from advisor.model.lateral import LATERAL
from advisor.model.mil_f_8785c import MANNED
from advisor.oem.estimate import ChannelFit
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.report.lateral_qualities import MODES, NAMES, levels_of, modes_told, tests_of
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, Section, listing
from advisor.report.page.content import Content
from advisor.report.page.drawing import picture
from advisor.report.page.fits import paint_input, paint_output
from advisor.report.page.maneuvers import HEAD, maneuver_row
from advisor.report.result_rows import parameter_row
from advisor.report.table import Table
from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import CHANNELS
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


_EXPLAINED = (
    "Grey: measured. Dark dashes: the lateral model fitted to this manoeuvre alone. The aileron is positive "
    "where it rolls to the left, the rudder where it yaws to the left."
)
_MOST = 6
"""Most pictures: the manoeuvres that are explained worst and best are among them."""
Inputs = Sequence[tuple[str, Channel]]


def lateral_fits(state: LateralState) -> Iterator[Block]:
    """Return the fits of the accepted manoeuvres: the worst and the best one, then others as room allows."""
    accepted = [
        (one, one.estimate)
        for one in state.maneuvers
        if one.verdict.accepted and isinstance(one.estimate, LateralEstimate)
    ]
    if not accepted:
        return
    yield Paragraph(_EXPLAINED)
    by_fit = sorted(accepted, key=lambda one: _explained(one[1]))
    kept = [*by_fit[:1], *reversed(by_fit[1:])][:_MOST]
    shown = sorted(kept, key=lambda one: one[0].maneuver.number)
    yield Gallery(tuple(_figure(judged, estimate) for judged, estimate in shown))


def _explained(found: LateralEstimate) -> float:
    """Return the mean share of the motion that the fit explains."""
    return fmean(fit.r2 for fit in found.estimate.fits[0].values())


def _figure(judged: JudgedLateral, found: LateralEstimate) -> Figure:
    maneuver = judged.maneuver
    inputs = [(name, maneuver.channels[name]) for name in LATERAL.inputs if name in maneuver.channels]
    outputs = tuple(found.estimate.fits[0].values())
    svg = picture(
        f"lateral-fit-{maneuver.number}", 3.6, 0.7 + 0.85 * (len(inputs) + len(outputs)), _paint,
        inputs, outputs, maneuver.span.start_s,
    )  # fmt: skip
    told = ", ".join(f"{CHANNELS[fit.name].symbol} R² {fit.r2:.3f}" for fit in outputs)
    return Figure(svg, f"Manoeuvre {maneuver.number}, {maneuver.span.kind}: {told}.", "half")


def _paint(drawing: Drawing, inputs: Inputs, outputs: Sequence[ChannelFit], start_s: float) -> None:
    rows = drawing.subplots(len(inputs) + len(outputs), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, channel) in zip(rows, inputs, strict=False):
        paint_input(axes, name, channel, start_s)
    for axes, fit in zip(rows[len(inputs) :], outputs, strict=True):
        paint_output(axes, fit, start_s)
    for axes in rows:
        axes.locator_params(axis="y", nbins=4)
    rows[-1].set_xlabel("time since the first step [s]")
    drawing.align_ylabels(list(rows))
