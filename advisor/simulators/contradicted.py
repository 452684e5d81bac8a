"""An answer that held-out manoeuvres contradict: its probability goes to the remaining corrections."""

import math
from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.alternative import Alternative, AlternativeEvidence, Contribution, together
from advisor.gap.decision import Decision
from advisor.gap.inference.posterior import PARAMETERS, stated_as
from advisor.gap.result import Diagnosis, GapVerdict, Where
from advisor.gap.verdict.text import answers_of, sentence_of
from advisor.words.certainty import DECIDED, as_sure

_IMPOSSIBLE = 1e-300
"""Numerical: probability that replaces zero in log odds."""


def contradicted(diagnosis: Diagnosis, removed: float) -> Diagnosis:
    """Return the diagnosis without its withdrawn answer.

    The answer's probability goes to the remaining corrections, if these remove half of the gap. Otherwise the
    probability goes to an effect without a name, in the answer's block.

    Parameters
    ----------
    removed
        Share of the gap on held-out manoeuvres that the remaining corrections remove.
    """
    d = diagnosis
    given_up = d.answer or PARAMETERS
    present = [cause for cause in d.causes if cause.present]
    stays = stated_as(present[0].effect) if present else PARAMETERS
    if removed < 0.5:
        stays = Alternative("unknown", "unknown", given_up.block or d.where.block)
        present = []
    gone = [cause for cause in d.causes if cause.effect == given_up.name]
    causes = tuple(replace(c, present=c in present) for c in d.causes if c not in gone)
    evidence = handed_over(d.evidence, given_up, stays)
    d = answered_by(d, evidence, stays)
    unknown, flown = d.verdict == "unknown", d.in_simulator
    d = replace(
        d, causes=causes, where=_where(d, stays, removed),
        waterfall=tuple(step for step in d.waterfall if step[0] != given_up.name),
        effects={} if unknown else d.effects, shrink=None if unknown else d.shrink,
        in_simulator=flown and replace(flown, after=None, percent=None),
    )  # fmt: skip
    closest = (*gone, *causes) if unknown else causes
    sentence = sentence_of(d.verdict, d.gap, d.where, closest, d.shrink)
    return replace(d, sentence=as_sure(sentence, answers_of(d.evidence)))


def handed_over(
    evidence: Sequence[AlternativeEvidence], given_up: Alternative, stays: Alternative
) -> tuple[AlternativeEvidence, ...]:
    """Return the evidence with the probability of a withdrawn answer given to another alternative."""
    share = sum(one.probability for one in evidence if one.alternative == given_up)
    left = [one for one in evidence if one.alternative != given_up]
    return with_share(left, stays, share) if evidence else ()


def with_share(
    known: Sequence[AlternativeEvidence], alternative: Alternative, share: float
) -> tuple[AlternativeEvidence, ...]:
    """Return the evidence with more probability for one alternative, and proportionally less for the others.

    The likeliest alternative is first.
    """
    scale = (1.0 - share) / max(sum(one.probability for one in known), _IMPOSSIBLE)
    others = [replace(one, probability=scale * one.probability) for one in known]
    mine = next((one for one in others if one.alternative == alternative), None)
    mine = mine or AlternativeEvidence(alternative, (), 0.0)
    more = replace(mine, probability=mine.probability + share)
    rest = [one for one in others if one.alternative != alternative]
    return tuple(sorted([more, *rest], key=lambda one: -one.probability))


def answered_by(
    diagnosis: Diagnosis, evidence: tuple[AlternativeEvidence, ...], answer: Alternative
) -> Diagnosis:
    """Return the diagnosis with an answer from flights of the simulator, and its odds."""
    verdict: GapVerdict = "effect" if answer.is_effect else answer.kind  # type: ignore[assignment]
    d = replace(diagnosis, verdict=verdict, evidence=evidence, answer=answer, why=(), rival="", decisions=())
    ranked = together((one.alternative, one.probability) for one in evidence)
    if len(ranked) < 2:
        return d
    (_, p), (rival, q) = ranked[:2]
    odds = math.log(p / max(q, _IMPOSSIBLE))
    about = answer.block if answer.kind == "unknown" else answer.name
    return replace(
        d, rival=rival.label,
        why=(Contribution("flown", odds, "flights of the simulator with the correction"),),
        decisions=(
            Decision(about, "against its rival", odds, 0.0, "nats"),
            Decision(about, "decided", p, DECIDED, "probability"),
        ),
    )  # fmt: skip


def _where(d: Diagnosis, answer: Alternative, removed: float) -> Where:
    """Return the block of the answer; for derivatives, the equation of the one that differs most."""
    if answer.kind == "unknown":
        known = d.probabilities
        blocks = {answer.block: 1.0} if known is None else known.unknown
        most = max(blocks.values())
        ranking = tuple((block, round(p / most, 4)) for block, p in blocks.items())
        return Where(answer.block, blocks[answer.block] / sum(blocks.values()), ranking)
    block = answer.block
    if not block:
        first = next((one.name for one in d.derivatives), "")
        block = {"Z": "force_equation", "M": "moment_equation"}.get(first[:1], d.where.block)
    others = tuple((other, score) for other, score in d.where.ranking if other != block and score < 1.0)
    return Where(block, removed, ((block, 1.0), *others))
