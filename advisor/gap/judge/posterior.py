"""The posterior: the probability of every alternative, given the evidence and the field prior."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Alternative, AlternativeEvidence, Contribution, Probabilities
from advisor.gap.evidence.quantities import QUANTITIES
from advisor.gap.evidence.rows import Row
from advisor.gap.judge.logit import Logit
from advisor.gap.judge.prior import FieldPrior
from advisor.gap.judge.weights import LOGIT
from advisor.gap.judge.why import reasons

CREDIBLE = 0.9
"""Probability that the stated alternatives must have together. A single alternative with less is not stated
alone: 0.9 is what a reader takes for sure."""


@dataclass(frozen=True)
class Posterior:
    """Every alternative with its evidence and its probability."""

    rows: tuple[Row, ...]
    probability: FloatArray
    """Shape (rows,); sums to 1."""
    prior: FieldPrior
    logit: Logit

    def of(self, alternative: Alternative) -> float:
        """Return the probability of the first cause of an alternative; 0 where no row states it."""
        return dict(self.first_causes).get(alternative.first, 0.0)

    @property
    def first_causes(self) -> tuple[tuple[Alternative, float], ...]:
        """The first causes with their probabilities, likeliest first; a set counts for its main effect."""
        found: dict[Alternative, float] = {}
        for row, p in self._pairs():
            found[row.alternative.first] = found.get(row.alternative.first, 0.0) + p
        return tuple(sorted(found.items(), key=lambda pair: -pair[1]))

    @property
    def probabilities(self) -> Probabilities:
        """The probabilities as the contract arranges them."""
        causes = self.first_causes
        named = {one.name: p for one, p in causes if one.kind != "unknown"}
        return Probabilities(
            none=named.pop("none", 0.0),
            parameters=named.pop("parameters", 0.0),
            unknown={one.block: p for one, p in causes if one.kind == "unknown"},
            effects=named,
        )

    @property
    def evidence(self) -> tuple[AlternativeEvidence, ...]:
        """Every alternative with all columns, likeliest first."""
        return tuple(
            AlternativeEvidence(
                row.alternative, tuple(q.column(row.values.get(q.name, 0.0)) for q in QUANTITIES), float(p)
            )
            for row, p in sorted(self._pairs(), key=lambda pair: -pair[1])
        )

    @property
    def credible(self) -> tuple[tuple[Alternative, float], ...]:
        """The fewest first causes that have ``CREDIBLE`` together, likeliest first."""
        causes = self.first_causes
        before = np.cumsum([0.0, *(p for _, p in causes)])[:-1]
        return tuple(cause for cause, b in zip(causes, before, strict=True) if b < CREDIBLE)

    def rival_of(self, answer: Alternative) -> Alternative:
        """Return the likeliest alternative with another first cause than the answer."""
        others = [(p, r.alternative) for r, p in self._pairs() if r.alternative.first != answer.first]
        return max(others, key=lambda pair: pair[0])[1]

    def why(self, answer: Alternative) -> tuple[Contribution, ...]:
        """Return the contributions to the log odds of an answer against its strongest rival; empty where no
        row states the answer."""
        stated = [row.alternative for row in self.rows]
        if answer not in stated:
            return ()
        mine, other = stated.index(answer), stated.index(self.rival_of(answer))
        offsets = self.logit.offsets(self.rows, self.prior)
        return reasons(self.logit, self.rows[mine], self.rows[other], float(offsets[mine] - offsets[other]))

    def _pairs(self) -> list[tuple[Row, float]]:
        return list(zip(self.rows, map(float, self.probability), strict=True))


def posterior(rows: Sequence[Row], prior: FieldPrior, logit: Logit = LOGIT) -> Posterior:
    """Return the probabilities of all alternatives."""
    return Posterior(tuple(rows), logit.probabilities(rows, prior), prior, logit)
