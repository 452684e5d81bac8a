"""Contradictions of the instruments over a campaign. All manoeuvres of a power-on share their instruments."""

from collections.abc import Iterable
from dataclasses import replace

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.instrument_finding import InstrumentFinding


def as_known_by(maneuver: Maneuver, newest: Maneuver) -> Maneuver:
    """Return an earlier manoeuvre with what a later one of its power-on tells; unchanged without news.

    A contradiction that only later manoeuvres show was not removed from the earlier one's channels.
    """
    removed = {f.code for f in maneuver.findings if f.used}
    told = tuple(f if f.code in removed else replace(f, used=False) for f in newest.findings)
    if maneuver.power_on != newest.power_on or _codes(told) == _codes(maneuver.findings):
        return maneuver
    return replace(maneuver, findings=told)


def together(
    maneuvers: Iterable[Maneuver], before_flying: Iterable[InstrumentFinding]
) -> tuple[InstrumentFinding, ...]:
    """Return each contradiction once, as the newest manoeuvre that shows it tells it."""
    found = {f.code: f for f in before_flying}
    for maneuver in maneuvers:
        found |= {f.code: f for f in maneuver.findings}
    return tuple(found.values())


def _codes(findings: Iterable[InstrumentFinding]) -> set[tuple[str, bool]]:
    return {(f.code, f.refuses) for f in findings}
