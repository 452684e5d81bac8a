"""A diagnosis with the probabilities of its alternatives, and the reasons for its answer."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.alternative import Alternative
from advisor.gap.candidates.traits import TRAITS
from advisor.gap.judge.posterior import Posterior
from advisor.gap.result import Cause, Diagnosis, spelled
from advisor.gap.search.indistinguishable import way_to_distinguish
from advisor.gap.verdict.text import place


def as_judged(diagnosis: Diagnosis, told: Posterior) -> Diagnosis:
    """Return the diagnosis with probabilities, evidence and reasons; a doubtful answer says so in a note."""
    answer = answered(diagnosis)
    reasons = told.why(answer)
    doubt = doubtful(told.credible)
    alike = [a.name for a, _ in told.credible if a.kind in ("effect", "air")] if doubt else []
    causes = tuple(_with_rivals(c, alike) if n == 0 else c for n, c in enumerate(diagnosis.causes))
    return replace(
        diagnosis,
        causes=causes,
        probabilities=told.probabilities,
        evidence=told.evidence,
        why=reasons,
        rival=told.rival_of(answer).label if reasons else "",
        notes=(*((doubt,) if doubt else ()), *diagnosis.notes),
    )


def answered(diagnosis: Diagnosis) -> Alternative:
    """Return the answer of a diagnosis as an alternative."""
    if diagnosis.verdict == "effect":
        first = diagnosis.causes[0]
        return Alternative("air" if first.block == "air" else "effect", first.effect, first.block)
    if diagnosis.verdict == "unknown":
        return Alternative("unknown", "unknown", diagnosis.where.block)
    name = "parameters" if diagnosis.verdict == "parameters" else "none"
    return Alternative("parameters" if name == "parameters" else "none", name)


def doubtful(credible: Sequence[tuple[Alternative, float]]) -> str:
    """Return the sentence about alternatives that the evidence cannot decide between; empty for one alone."""
    if len(credible) < 2:
        return ""
    listed = [f"{_said(a)} ({100.0 * p:.0f} %)" for a, p in credible[:3]]
    more = " and others" if len(credible) > 3 else ""
    return f"The evidence does not decide between {', '.join(listed[:-1])} and {listed[-1]}{more}."


def _said(alternative: Alternative) -> str:
    words = {"none": "no gap", "parameters": "wrong numbers"}
    if alternative.kind == "unknown":
        return f"something without a name {place(alternative.block)}"
    return words.get(alternative.kind, spelled(alternative.name))


def _with_rivals(cause: Cause, alike: Sequence[str]) -> Cause:
    """Return a cause with the effects that the evidence cannot exclude, and what distinguishes them."""
    rivals = [name for name in alike if name not in (cause.effect, *cause.cannot_be_told_from)]
    ways = [
        way for name in rivals if cause.effect in TRAITS and (way := way_to_distinguish(cause.effect, name))
    ]
    way = "; ".join(dict.fromkeys(filter(None, (cause.tell_apart_by, *ways))))
    return replace(cause, cannot_be_told_from=(*cause.cannot_be_told_from, *rivals), tell_apart_by=way)
