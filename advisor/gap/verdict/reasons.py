"""Reasons of an answer: its strongest rival, and the parts of the log odds between both."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from advisor.gap.alternative import Alternative, AlternativeEvidence, Column, Contribution, Weighed, together
from advisor.gap.decision import Decision
from advisor.gap.inference.explanation import Row
from advisor.gap.inference.posterior import NONE, PARAMETERS, UNKNOWN, Posterior, posterior_of, relabelled
from advisor.words.certainty import DECIDED

VISIBLE_GAP, _LEAST_DOUBT = 2.0, 0.05
"""Contract: gap on held-out manoeuvres, and the largest probability of "no gap" in its presence."""
_WORDS = {
    "prior": "prior probability of each answer",
    "fit": "fit to the manoeuvres",
    "numbers": "price of its numbers, and agreement with the aircraft file",
    "unseen": "loss on held-out manoeuvres",
    "model_error": "allowance for the error of every simulator",
    "residual": "remaining residual",
    "second": "second cause in addition",
    "natural": "first cause no larger than on every aircraft",
    "air": "how often the air moves",
    "offset": "offset of the angle of attack by the flight path",
    "steady": "turbulence as strong before and after the input as during it",
    "gap": "visible gap of the simulator as given",
    "rest": "less likely variants of each answer",
}
"""Words: name of each part of the log odds."""


def weighed(posterior: Posterior[Any]) -> Weighed:
    """Return the evidence of every alternative's likeliest model, and the rival.

    The rival is the likeliest alternative with another name than the answer.
    """
    answer, rival = posterior.answer, together(posterior.by_alternative.items())[1][0]
    label = answer.block if answer.kind == "unknown" else answer.name
    (_, probability), *_ = together(posterior.by_alternative.items())
    return Weighed(
        evidence=tuple(_evidence_in(posterior)),
        why=tuple(_why_of(posterior, rival)),
        answer=answer,
        rival=rival.label,
        decisions=(
            Decision(label, "against its rival", _log_odds(posterior, rival), 0.0, "nats"),
            Decision(label, "decided", probability, DECIDED, "probability"),
        ),
    )


def _evidence_in(posterior: Posterior[Any]) -> Iterator[AlternativeEvidence]:
    """Yield every alternative with the log weight's parts of its likeliest row."""
    for alternative, p in posterior.by_alternative.items():
        row = _best_row(posterior, alternative)
        columns = tuple(Column(n, value, "nats", _WORDS[n]) for n, value in row.terms.items())
        yield AlternativeEvidence(alternative, columns, p)


def _why_of(posterior: Posterior[Any], rival: Alternative) -> Iterator[Contribution]:
    """Yield the parts of the log odds between the answer and its rival, the largest first."""
    mine, other = (_best_row(posterior, a) for a in (posterior.answer, rival))
    names = dict.fromkeys([*mine.terms, *other.terms])
    parts = {name: mine.terms.get(name, 0.0) - other.terms.get(name, 0.0) for name in names}
    parts["rest"] = _log_odds(posterior, rival) - sum(parts.values())
    for name, nats in sorted(parts.items(), key=lambda item: -abs(item[1])):
        yield Contribution(name, nats, _WORDS[name])


def _log_odds(posterior: Posterior[Any], rival: Alternative) -> float:
    """Return the log odds of answer and rival, nats, over all blocks of an unnamed effect."""
    mine, other = (
        np.logaddexp.reduce([r.weight for r in posterior.rows if r.alternative.name == a.name])
        for a in (posterior.answer, rival)
    )
    return float(mine - other)


def _best_row(posterior: Posterior[Any], alternative: Alternative) -> Row[Any]:
    return max((r for r in posterior.rows if r.alternative == alternative), key=lambda row: row.weight)


def capped(posterior: Posterior[Any], gap: float, left: float) -> Posterior[Any]:
    """Return the posterior in which "no gap" has a probability of at most 5 % in the presence of a visible
    gap.

    A visible gap without an explanation is a gap of the derivatives, as far as fitted derivatives remove it.
    The rest has no name, and is in the likeliest effect's block where too few manoeuvres show one. Below the
    contract's gap the evidence alone says how likely "no gap" is.

    Parameters
    ----------
    gap
        Gap of the aircraft file's derivatives with the flight's natural numbers, or of the plain model where
        the file states none.
    left
        Gap of the plain model, whose derivatives are fitted.
    """
    none = posterior.of(NONE)
    if gap < VISIBLE_GAP or none <= _LEAST_DOUBT:
        return posterior
    by_numbers = float(np.clip(1.0 - left / gap, 0.0, 1.0))
    block = next((row.alternative for row in posterior.rows if row.alternative.kind == "unknown"), PARAMETERS)
    effects = (a.block for a in posterior.by_alternative if a.is_effect)
    if block == PARAMETERS and by_numbers == 0.0:
        block = replace(UNKNOWN, block=next(effects, "force_equation"))
    taken = 1.0 - _LEAST_DOUBT / none
    parts = ((NONE, 1.0 - taken), (PARAMETERS, taken * by_numbers), (block, taken * (1.0 - by_numbers)))
    logs = [(name, float(np.log(part))) for name, part in parts if part > 1e-300]
    kept = [row for row in posterior.rows if row.alternative != NONE]
    without = [row for row in posterior.rows if row.alternative == NONE]
    kept += [relabelled(replace(w, terms={**w.terms, "gap": log}), a) for w in without for a, log in logs]
    return posterior_of(kept)
