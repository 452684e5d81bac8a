"""The title over the answer of a diagnosis, and the answers in words."""

from collections.abc import Sequence

from advisor.gap.alternative import AlternativeEvidence, together
from advisor.gap.result import VISIBLE, Diagnosis, GapVerdict
from advisor.gap.verdict.text import in_words
from advisor.words.certainty import Answers, title

_TITLES = {
    "none": ("NOTHING TO CORRECT", "LIKELY NOTHING TO CORRECT"),
    "parameters": ("WRONG NUMBERS", "LIKELY WRONG NUMBERS"),
    "effect": ("CAUSE FOUND", "LIKELY CAUSE"),
    "unknown": ("UNKNOWN CAUSE", "LIKELY UNKNOWN CAUSE"),
    "untested": ("NO SIMULATOR GIVEN", "NO SIMULATOR GIVEN"),
}


def answers_of(evidence: Sequence[AlternativeEvidence]) -> Answers:
    """Return the answers in words with their probabilities, the likeliest first."""
    shares = together((one.alternative, one.probability) for one in evidence)
    return [(in_words(alternative), p) for alternative, p in shares]


def title_of_verdict(verdict: GapVerdict, answers: Answers) -> str:
    """Return the title over a verdict."""
    return title(*_TITLES[verdict], answers)


def title_of(d: Diagnosis) -> str:
    """Return the title over a diagnosis."""
    shown = title_of_verdict(d.verdict, answers_of(d.evidence))
    is_free = d.verdict == "none" and d.gap.before < VISIBLE
    return shown.replace("NOTHING TO CORRECT", "NO GAP") if is_free else shown
