"""Words for the answer of a diagnosis: its title, the answers, and its limits, for every face."""

from collections.abc import Iterator, Sequence

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


def limits_of(d: Diagnosis) -> Iterator[str]:
    """Yield the limits of the answer, which stand next to the answer."""
    if d.verdict != "untested" and not d.derivatives:
        yield "No simulator was given: the answer is about the flight alone."
    air = "The air moved, and its course was fitted to the same samples."
    beyond_air = None if d.shrink is None else d.shrink.beyond_air_percent
    if beyond_air is not None:
        yield f"{air} Beyond the air the gap falls by {beyond_air:.0f} %."
    elif d.gap.by_air > VISIBLE:
        yield f"{air} That flatters the gap after."
    if len(d.maneuvers) == 1:
        yield "One manoeuvre alone proves no cause."
    if d.although_refused:
        numbers = ", ".join(map(str, d.although_refused))
        several = len(d.although_refused) > 1
        used = f"Manoeuvres {numbers} are" if several else f"Manoeuvre {numbers} is"
        yield f"{used} used, although advisor analyze refuses {'them' if several else 'it'}."
