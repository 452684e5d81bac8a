"""Laws that no effect describes: what the residuals of the likeliest models tell of them."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.inference.residual import if_lacking, if_right
from advisor.side_gap.evidence import probabilities
from advisor.side_gap.models import Case
from advisor.side_gap.moving_air import Model
from advisor.side_gap.residual import Beside, residual_of

_SEARCHED = 2
"""Numerical: number of models, the likeliest, whose residual is searched. Others count with the residual of
the likeliest."""


class Posterior(NamedTuple):
    """Probabilities of all explanations, which sum to 1."""

    known: FloatArray
    """(2, n) probability of each model in still and in moving air."""
    unknown: Mapping[str, float]
    """Probability of a law that no effect describes, by block."""


def residuals_of(case: Case, models: Sequence[Model], weight: FloatArray, share: float) -> list[Beside]:
    """Return the residual of every model: its own, or that of the likeliest one.

    Parameters
    ----------
    weight
        (n,) log weight of each model.
    share
        Share of white noise in the residuals.
    """
    order = dict.fromkeys(id(models[k].fit) for k in np.argsort(-weight))
    fits = {id(model.fit): model.fit for model in models}
    near = {one: residual_of(fits[one], case.flown, share) for one in list(order)[:_SEARCHED]}
    of_the_likeliest = near[next(iter(order))]
    return [near.get(id(model.fit), of_the_likeliest) for model in models]


def with_a_lacking_law(
    still: FloatArray, blown: FloatArray, residuals: Sequence[Beside], share: float
) -> Posterior:
    """Return the probabilities of models that are right, and of a law that all of them lack.

    Parameters
    ----------
    still, blown
        (n,) log weight of each model in still and in moving air.
    residuals
        Residual of each model.
    share
        How often a law without a name is the cause, before a flight is looked at.
    """
    lacking = float(np.log(share / (1.0 - share)))
    right, unknown = np.empty((2, len(residuals))), dict[str, float]()
    for k, residual in enumerate(residuals):
        for air, (weight, size) in enumerate(
            ((still[k], residual.whole.size), (blown[k], residual.beside_air))
        ):
            right[air, k] = weight + if_right(size)
            for block, part in residual.blocks_but_air.items():
                nats = weight + lacking + if_lacking(size) + np.log(part)
                unknown[block] = float(np.logaddexp(unknown.get(block, -np.inf), nats))
    each = probabilities([*right.ravel(), *unknown.values()])
    blocks = zip(unknown, map(float, each[right.size :]), strict=True)
    return Posterior(each[: right.size].reshape(2, -1), dict(blocks))
