"""A conditional logit: a utility linear in the columns of the evidence, and a softmax over the rows.

McFadden, "Conditional logit analysis of qualitative choice behavior" (1974). The weights were fitted on
flights whose causes are known (``benchmarks.judge``), so that probabilities equal observed frequencies.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Kind
from advisor.gap.evidence.quantities import QUANTITIES
from advisor.gap.evidence.rows import Row
from advisor.gap.judge.prior import FieldPrior

SCALES = {quantity.name: quantity.scale for quantity in QUANTITIES}


def shared_prior(rows: Sequence[Row]) -> FloatArray:
    """Return the logarithm of every row's share of the prior of its first cause, nats, shape (rows,).

    A set of two shares the prior with its main effect alone: a second row makes no cause likelier.
    """
    causes = [row.alternative.first for row in rows]
    return -np.log([float(causes.count(cause)) for cause in causes])


@dataclass(frozen=True)
class Logit:
    """The fitted judge."""

    weights: Mapping[Kind, Mapping[str, float]]
    """Nats by kind of alternative and column, per unit of the column's scale."""
    intercepts: Mapping[Kind, float]
    """Nats by kind of alternative."""
    flown: FieldPrior
    """Shares of the answers among the flights of the fit."""

    def parts(self, row: Row) -> dict[str, float]:
        """Return the contribution of each column to the utility of a row, nats."""
        weights = self.weights.get(row.alternative.kind, {})
        return {name: w * SCALES[name](row.values.get(name, 0.0)) for name, w in weights.items()}

    def offset(self, kind: Kind, prior: FieldPrior) -> float:
        """Return the part of the utility that no evidence changes, nats: intercept and field prior.

        The correction for the shares of the fit is King and Zeng's, "Logistic regression in rare events data"
        (2001).
        """
        return self.intercepts.get(kind, 0.0) + float(np.log(prior.of(kind) / self.flown.of(kind)))

    def offsets(self, rows: Sequence[Row], prior: FieldPrior) -> FloatArray:
        """Return the part of every row's utility that no evidence changes, nats, shape (rows,)."""
        return shared_prior(rows) + [self.offset(row.alternative.kind, prior) for row in rows]

    def utilities(self, rows: Sequence[Row], prior: FieldPrior) -> FloatArray:
        """Return the utility of every row, nats, shape (rows,)."""
        return self.offsets(rows, prior) + [sum(self.parts(row).values()) for row in rows]

    def probabilities(self, rows: Sequence[Row], prior: FieldPrior) -> FloatArray:
        """Return the probability of every row, shape (rows,), which sum to 1."""
        utility = self.utilities(rows, prior)
        weights = np.exp(utility - np.max(utility))
        return np.asarray(weights / np.sum(weights))
