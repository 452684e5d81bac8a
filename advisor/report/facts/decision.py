"""Texts of the decision, stop or continue, and of the next input, for terminal, page and announcements."""

from collections.abc import Iterator

from advisor.campaign.state import CampaignState, LateralState
from advisor.decision.verdict import FlightTestVerdict

INDENT = "  "
"""Indentation of the lines below a decision."""
WARNING = f"{INDENT}warning: "
"""Beginning of a line with a warning."""


def stop_line(verdict: FlightTestVerdict) -> str:
    """Return the line with stop or continue, the criterion and its limit."""
    mark = "■" if verdict.decision == "stop" else "▶"
    return f"{mark} {verdict.sentence}"


def next_line(verdict: FlightTestVerdict) -> str:
    """Return the next input, and the expected number of further manoeuvres."""
    if verdict.next is None:
        return "no advice yet"
    more = "" if verdict.decision == "stop" else verdict.next.foretold
    return "; ".join(filter(None, (verdict.next.advice, more)))


def decisions(state: CampaignState, *, pitch: bool = True) -> Iterator[str]:
    """Yield stop or continue of each axis, with one next input if both axes are tested."""
    plan = state.plan if pitch else None
    side = state.lateral
    # An axis that nobody flew is not judged next to an axis that was flown.
    if pitch and state.tested_sideways is None:
        yield from _decision(stop_line(state.flight_test), state.flight_test, advises=plan is None)
    # Roll and yaw that nobody flew are said only where nothing else was flown, or an output is not known.
    if side is not None and (side.maneuvers or side.flight_test.next is None or not state.maneuvers):
        yield from lateral_decision(side, advises=plan is None)
    if plan is not None:
        yield f"Both axes: {plan.sentence}"
        yield f"{INDENT}{plan.advice}"


def lateral_decision(state: LateralState, *, advises: bool = True) -> Iterator[str]:
    """Yield stop or continue of roll and yaw, warnings, and the next input."""
    verdict = state.flight_test
    advises = advises and bool(state.maneuvers) and verdict.next is not None
    yield from _decision(f"Roll and yaw: {verdict.sentence}", verdict, advises=advises)


def _decision(lead: str, verdict: FlightTestVerdict, *, advises: bool) -> Iterator[str]:
    yield lead
    yield from (f"{WARNING}{warning}" for warning in verdict.warnings)
    if advises:
        yield f"{INDENT}{next_line(verdict)}"
