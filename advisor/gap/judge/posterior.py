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
        """Return the probability of an alternative; 0 where no row states it."""
        return float(sum(p for row, p in self._pairs() if row.alternative == alternative))

    def of_effect(self, name: str) -> float:
        """Return the probability that an effect is the main cause."""
        return float(sum(p for row, p in self._pairs() if row.alternative.name == name))

    @property
    def probabilities(self) -> Probabilities:
        """The probabilities as the contract arranges them."""
        pairs = self._pairs()
        return Probabilities(
            none=self.of_effect("none"),
            parameters=self.of_effect("parameters"),
            unknown={r.alternative.block: float(p) for r, p in pairs if r.alternative.kind == "unknown"},
            effects={r.alternative.name: float(p) for r, p in pairs if r.alternative.is_effect},
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
        """The fewest alternatives that have ``CREDIBLE`` together, likeliest first."""
        ordered = sorted(self._pairs(), key=lambda pair: -pair[1])
        before = np.cumsum([0.0, *(p for _, p in ordered)])[:-1]
        return tuple(
            (row.alternative, float(p)) for (row, p), b in zip(ordered, before, strict=True) if b < CREDIBLE
        )

    def rival_of(self, answer: Alternative) -> Alternative:
        """Return the likeliest alternative to an answer."""
        others = [(p, row.alternative) for row, p in self._pairs() if row.alternative != answer]
        return max(others, key=lambda pair: pair[0])[1]

    def why(self, answer: Alternative) -> tuple[Contribution, ...]:
        """Return the contributions to the log odds of an answer against its strongest rival; empty where no
        row states the answer."""
        by_alternative = {row.alternative: row for row in self.rows}
        if answer not in by_alternative:
            return ()
        rival = by_alternative[self.rival_of(answer)]
        return reasons(self.logit, by_alternative[answer], rival, self.prior)

    def _pairs(self) -> list[tuple[Row, float]]:
        return list(zip(self.rows, map(float, self.probability), strict=True))


def posterior(rows: Sequence[Row], prior: FieldPrior, logit: Logit = LOGIT) -> Posterior:
    """Return the probabilities of all alternatives."""
    return Posterior(tuple(rows), logit.probabilities(rows, prior), prior, logit)
