"""First page: flights, verdict, the eight parameters, and the gap in one sentence and picture."""

from collections.abc import Iterator

from advisor.report.facts.estimates import untold
from advisor.report.page.axes.lateral_section import decided
from advisor.report.page.blocks import Block, Content, Paragraph, listing, section
from advisor.report.page.gap import glance
from advisor.report.table import Table, joint_table


@section("verdict", "Verdict")
def headline(content: Content) -> Iterator[Block]:
    """Yield flights, decision and evidence, estimates, and gap."""
    verdict, maneuvers = content.analysis["flight_test"], content.analysis["maneuvers"]
    accepted = [m["number"] for m in maneuvers if m["verdict"] == "accepted"]
    yield _flown(content)
    state = content.state
    sideways = state.tested_sideways is not None
    yield from decided(state)
    side = state.lateral_alone
    if side is not None and (glance_at := joint_table(side, content.aircraft.model, "lateral-glance")):
        yield glance_at
    if sideways:
        yield Paragraph(verdict["sentence"])
    if maneuvers and not sideways:
        yield Paragraph(
            f"{len(accepted)} of {len(maneuvers)} manoeuvres are accepted. The rule {verdict['rule']} "
            f"decides: {_criterion(verdict['criterion_percent'], verdict['limit_percent'])}."
        )
    joint = joint_table(state, content.aircraft.model)
    if joint is not None and state.model is not None:
        yield joint
        yield from listing(untold(state.model))
    gap = content.gap
    if gap is not None and gap["usable"]:
        yield from glance(gap)


def _flown(content: Content) -> Table:
    mass = content.aircraft.reference.mass_kg
    weighs = "mass not given" if mass is None else f"{mass:g} kg"
    rows = []
    for flight, name in enumerate(content.names):
        heard = next((log for log in content.state.flights if log.flight == flight), None)
        vehicle = heard.vehicle if heard is not None else None
        minutes, seconds = divmod(round(heard.duration_s), 60) if heard is not None else (0, 0)
        rows.append(
            (
                name,
                content.begun[flight] if flight < len(content.begun) else "–",
                f"{minutes} min {seconds} s",
                str(vehicle) if vehicle is not None else "–",
                (vehicle.firmware if vehicle is not None else None) or "–",
            )
        )
    head = ("log", "began", "duration", "vehicle", "firmware")
    return Table("flown", f"{content.aircraft.name}, {weighs}.", head, tuple(rows))


def _criterion(value: float | None, limit: float) -> str:
    if value is None:
        return f"its criterion has no value yet (limit {limit:g} %)"
    return f"its criterion is {value:.1f} % (limit {limit:g} %)"
