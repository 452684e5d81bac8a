"""The first lines of the page: stop or continue, and the evidence."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Paragraph, Section, listing
from advisor.report.page.content import Content


def headline(content: Content) -> Section:
    """Return decision, counts, next input, warnings."""
    return Section("verdict", "Verdict", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    verdict, maneuvers = content.analysis["flight_test"], content.analysis["maneuvers"]
    accepted = [m["number"] for m in maneuvers if m["verdict"] == "accepted"]
    mark = "■" if verdict["decision"] == "stop" else "▶"
    yield Paragraph(f"{mark} {verdict['sentence']}", "verdict")
    yield Paragraph(
        f"{len(accepted)} of {len(maneuvers)} manoeuvres are accepted. The rule {verdict['rule']} decides: "
        f"{_criterion(verdict['criterion_percent'], verdict['limit_percent'])}."
    )
    following = verdict["next"]
    if following is not None:
        yield Paragraph(f"Next: {following['advice'].removeprefix('next: ')}.".replace("..", "."))
    yield from listing([f"Warning: {warning}" for warning in verdict["warnings"]])


def _criterion(value: float | None, limit: float) -> str:
    if value is None:
        return f"its criterion has no value yet (limit {limit:g} %)"
    return f"its criterion is {value:.1f} % (limit {limit:g} %)"
