"""A given simulator on a flight, with the flight's own nuisance parameters ("natural numbers").

Lateness, filters, the true over the read air speed and the autopilot's angle of attack belong to the flight,
not to the simulator. Every simulator that is compared on a flight therefore flies with natural numbers fitted
next to its own derivatives and effects.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.prior import derivative_scale
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.process.arrays import FloatArray

_GIVEN = 1e-4
"""Numerical: relative width within which a fit keeps a given parameter."""
_ROUNDS = 6
"""Numerical: number of Gauss-Newton steps of the natural numbers, in which the outputs are nearly linear."""


def with_natural(
    problem: EffectProblem,
    model: SearchPoint,
    fitted: SearchPoint,
    noise: FloatArray,
    aside: Collection[int] = (),
) -> SearchPoint:
    """Return a given model with the natural numbers of a flight, fitted next to the model's derivatives and
    effects.

    Parameters
    ----------
    model
        Derivatives and effects, which stay. Natural numbers of the model are replaced.
    fitted
        Fitted model of the flight, whose natural numbers start the search.
    noise
        Shape (channels,): standard deviation of the innovations in the first step.
    aside
        Indices of the manoeuvres on which the model is judged. The fit excludes these manoeuvres.
    """
    given = model.keeping([k for k, effect in enumerate(model.effects) if not effect.is_nuisance])
    start = replace(given, edges=None)
    for effect, values in zip(fitted.effects, fitted.values, strict=True):
        if effect.is_nuisance:
            start = start.with_effect(effect, values)
    if start.effects == given.effects:
        return start
    fields = {name: getattr(problem, name) for name in EffectProblem.__dataclass_fields__}
    made = fit(_Given(**fields, given=given.shared), start, noise, _ROUNDS, aside=aside)
    if not np.isfinite(made.cost):
        return start
    kept = np.concatenate([given.shared, made.point.shared[len(given.shared) :]])
    return made.point.moved(kept, made.point.own)


@dataclass(frozen=True)
class _Given(EffectProblem):
    """A flight next to a model whose derivatives and effects are given."""

    given: FloatArray | None = None
    """Shape (k,): derivatives and parameters of the effects."""

    def prior_of(self, point: SearchPoint) -> tuple[FloatArray, FloatArray]:
        """Return inverse prior variances of the shared parameters, and prior mean minus values, shapes
        (n,)."""
        assert self.given is not None
        inverse, departure = super().prior_of(point)
        k = len(self.given)
        steps = [step for effect in point.effects for step in effect.steps]
        scale = np.concatenate([derivative_scale(self.given[: len(DERIVATIVES)]), steps])[:k]
        inverse[:k] = 1.0 / (_GIVEN * scale) ** 2
        departure[:k] = self.given - point.shared[:k]
        return inverse, departure
