"""Titles of a diagnosis with their probabilities, and texts of the decision and of the next input."""

from collections.abc import Iterator, Sequence
from math import exp, log

from advisor.campaign.state import CampaignState, LateralState
from advisor.decision.verdict import FlightTestVerdict
from advisor.gap.alternative import AlternativeEvidence, together
from advisor.gap.result import VISIBLE, Diagnosis
from advisor.gap.verdict.text import answers_of, in_words
from advisor.report.facts.reasons import how_sure
from advisor.words.certainty import Answers, title

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


_TITLES = {
    "none": ("NOTHING TO CORRECT", "LIKELY NOTHING TO CORRECT"),
    "parameters": ("WRONG NUMBERS", "LIKELY WRONG NUMBERS"),
    "effect": ("CAUSE FOUND", "LIKELY CAUSE"),
    "unknown": ("UNKNOWN CAUSE", "LIKELY UNKNOWN CAUSE"),
    "untested": ("NOTHING TO COMPARE WITH", "NOTHING TO COMPARE WITH"),
}
_BEFORE_THE_FLIGHT = frozenset({"prior", "air"})
"""Columns of the evidence that hold the prior log probability of an alternative."""


def by_flight_alone(evidence: Sequence[AlternativeEvidence]) -> Answers:
    """Return the answers with the probabilities that this flight alone gives, the likeliest first.

    All alternatives then have equal prior probabilities.
    """
    if not evidence:
        return []
    before = [sum(c.value for c in e.columns if c.name in _BEFORE_THE_FLIGHT) for e in evidence]
    logs = [log(max(e.probability, 1e-300)) - nats for e, nats in zip(evidence, before, strict=True)]
    weights = [exp(value - max(logs)) for value in logs]
    total = sum(weights)
    shares = ((e.alternative, w / total) for e, w in zip(evidence, weights, strict=True))
    return [(in_words(alternative), p) for alternative, p in together(shares)]


def is_turned(evidence: Sequence[AlternativeEvidence]) -> bool:
    """Return whether another answer is the likeliest with equal prior probabilities."""
    answers, alone = answers_of(evidence), by_flight_alone(evidence)
    return bool(answers) and answers[0][0] != alone[0][0]


def sure_of(d: Diagnosis) -> str:
    """Return the sentence about the likeliest answers; empty without a simulator to compare with."""
    tested = d.verdict != "untested"
    return how_sure(answers_of(d.evidence), by_flight_alone(d.evidence)) if tested else ""


def title_of(d: Diagnosis) -> str:
    """Return the title of a diagnosis. An answer that is likeliest only by its prior is called likely."""
    stated, likely = _TITLES[d.verdict]
    shown = title(likely if is_turned(d.evidence) else stated, likely, answers_of(d.evidence))
    # Only pitch says in its title that a gap is not visible.
    is_free = d.axis == "pitch" and d.verdict == "none" and d.gap.before < VISIBLE
    return shown.replace("NOTHING TO CORRECT", "NO GAP") if is_free else shown
