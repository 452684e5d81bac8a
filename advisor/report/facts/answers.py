"""Titles of a diagnosis, and the probabilities that the flight alone gives."""

from collections.abc import Sequence
from math import exp, log

from advisor.gap.alternative import AlternativeEvidence, together
from advisor.gap.result import VISIBLE, Diagnosis
from advisor.gap.verdict.text import answers_of, in_words
from advisor.report.facts.reasons import how_sure
from advisor.words.certainty import Answers, title

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
