"""A diagnosis with the probabilities of its alternatives, and the reasons for its answer."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from advisor.gap.alternative import Alternative
from advisor.gap.effects import EFFECTS
from advisor.gap.evidence.rows import stated_as
from advisor.gap.judge.posterior import Posterior
from advisor.gap.result import Cause, Diagnosis
from advisor.gap.search.indistinguishable import way_to_distinguish
from advisor.gap.verdict.text import in_words

MOST_CAUSES = 5
"""Words: most causes that are stated, so that a reader sees the likely ones."""


def as_judged(diagnosis: Diagnosis, told: Posterior) -> Diagnosis:
    """Return the diagnosis with probabilities, evidence, reasons, and the doubt that remains."""
    answer = answered(diagnosis, [row.alternative for row in told.rows])
    reasons = told.why(answer)
    doubt = doubtful(told.credible, (answer, told.of(answer)))
    alike = [a.name for a, _ in told.credible if a.is_effect] if doubt else []
    causes = [replace(c, probability=told.of(stated_as(c.effect))) for c in diagnosis.causes]
    # The causes of an effect, or next to an unknown, keep the order of what they remove.
    keeps = diagnosis.verdict in ("effect", "unknown")
    causes.sort(key=lambda c: (not (keeps and c.present), 0.0 if keeps and c.present else -c.probability))
    causes = [_with_rivals(c, alike) if n == 0 else c for n, c in enumerate(causes[:MOST_CAUSES])]
    return replace(
        diagnosis,
        causes=tuple(causes),
        probabilities=told.probabilities,
        evidence=told.evidence,
        why=reasons,
        rival=told.rival_of(answer).label if reasons else "",
        doubt=doubt,
    )


def answered(diagnosis: Diagnosis, stated: Collection[Alternative]) -> Alternative:
    """Return the answer of a diagnosis as an alternative: the set of its first two causes, if that is
    stated."""
    if diagnosis.verdict == "effect":
        first, second = (*(c.effect for c in diagnosis.causes if c.present), "", "")[:2]
        both = stated_as(first or diagnosis.causes[0].effect, second)
        return both if both in stated else both.first
    if diagnosis.verdict == "unknown":
        return Alternative("unknown", "unknown", diagnosis.where.block)
    if diagnosis.verdict == "parameters":
        return Alternative("parameters", "parameters")
    return Alternative("none", "none")


def doubtful(credible: Sequence[tuple[Alternative, float]], answer: tuple[Alternative, float]) -> str:
    """Return the sentence about alternatives that the evidence cannot decide between.

    It is empty where the answer is the only credible one. ``answer`` comes with its probability.
    """
    if answer[0] not in [alternative for alternative, _ in credible]:
        likelier, p = credible[0]
        return (
            f"By the evidence {in_words(likelier)} ({100.0 * p:.0f} %) is likelier than this answer "
            f"({100.0 * answer[1]:.0f} %)."
        )
    if len(credible) < 2:
        return ""
    listed = [f"{in_words(a)} ({100.0 * p:.0f} %)" for a, p in credible[:3]]
    more = " and others" if len(credible) > 3 else ""
    return f"The evidence does not decide between {', '.join(listed[:-1])} and {listed[-1]}{more}."


def _with_rivals(cause: Cause, alike: Sequence[str]) -> Cause:
    """Return a cause with the effects that the evidence cannot exclude, and what distinguishes them."""
    rivals = [name for name in alike if name not in (cause.effect, *cause.cannot_be_told_from)]
    ways = [
        way for name in rivals if cause.effect in EFFECTS and (way := way_to_distinguish(cause.effect, name))
    ]
    way = "; ".join(dict.fromkeys(filter(None, (cause.tell_apart_by, *ways))))
    return replace(cause, cannot_be_told_from=(*cause.cannot_be_told_from, *rivals), tell_apart_by=way)
