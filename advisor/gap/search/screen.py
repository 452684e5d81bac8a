"""Fast screening of all candidates: only the effect's own sensitivities are computed anew."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.neighbourhood import Neighbourhood, SimulatedPoint
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.kit.effect import Variant
from advisor.process.arrays import FloatArray

_STEPS = 4
"""Numerical: largest number of Gauss-Newton steps of a quick fit."""
_AT_ONCE = 64
"""Numerical: number of points that are simulated together, which fill the packs."""
_HARDLY = 6.0
"""Numerical: decrease of the cost (twice the log likelihood) below which a variant is dropped."""
_HOPELESS = 0.05
"""Numerical: share of the best decrease of the cost below which a variant is dropped."""


@dataclass(frozen=True)
class Screened:
    """A candidate after its quick fit."""

    variant: Variant
    point: SearchPoint
    cost: float
    """Cost of the quick fit, comparable with ``EffectFit.cost``."""
    noise: FloatArray

    @property
    def name(self) -> str:
        """Name of the effect that the candidate belongs to."""
        return self.variant.effect

    @property
    def price(self) -> float:
        """Cost of the quick fit plus twice the number of parameters (Akaike's criterion)."""
        return self.cost + 2.0 * len(self.variant.names)


_Descent = Generator[SearchPoint, tuple[SimulatedPoint | None, float], Screened | None]
"""Search that requests one point after another, and receives its evaluation and the best decrease of the
cost."""


class Screen:
    """A baseline model prepared for a few fit steps of each of many candidates."""

    def __init__(self, problem: EffectProblem, fitted: EffectFit, steps: int = _STEPS) -> None:
        self.problem, self.fitted, self.steps = problem, fitted, steps
        self.around = Neighbourhood(problem, fitted)

    def likeliest(self, variants: Sequence[Variant]) -> Screened | None:
        """Return the quick fit with the least cost including the price of its parameters; None without
        progress.

        Each parameter costs ln N (Schwarz 1978).
        """
        price = float(np.log(max(np.sum(self.around.count), 2.0)))
        return min(
            self.quick_fits(variants), key=lambda s: s.cost + price * len(s.variant.names), default=None
        )

    def quick_fits(self, variants: Sequence[Variant]) -> list[Screened]:
        """Return the best quick fit of each variant over its starts, for variants of which some start
        converges.

        Variants that promise far less than the best variant are dropped.
        """
        began = [(n, start) for n, variant in enumerate(variants) for start in variant.starts]
        ended = self._together([self._descend(variants[n], start) for n, start in began])
        best: dict[int, Screened] = {}
        for (n, _), end in zip(began, ended, strict=True):
            if end is not None and (n not in best or end.cost < best[n].cost):
                best[n] = end
        return list(best.values())

    def _together(self, descents: Sequence[_Descent]) -> list[Screened | None]:
        """Advance all searches together, so that the next points of many are simulated at once."""
        ended: list[Screened | None] = [None] * len(descents)
        most = 0.0
        asked = {n: next(descent) for n, descent in enumerate(descents)}
        while asked:
            some = list(asked)[:_AT_ONCE]
            places = self.around.at_all([asked.pop(n) for n in some])
            most = max([most, *(self.fitted.cost - place.cost for place in places if place is not None)])
            for n, place in zip(some, places, strict=True):
                try:
                    asked[n] = descents[n].send((place, most))
                except StopIteration as end:
                    ended[n] = end.value
        return ended

    def _descend(self, variant: Variant, start: tuple[float, ...]) -> _Descent:
        problem = self.problem
        sides = None if variant.sides is None else variant.sides[1]
        resting = None if sides is None else np.zeros(len(problem.flights))
        point = self.fitted.point.with_effect(variant, start, resting)
        if sides is not None:
            point = self.around.choose_sides(point, sides)
        here, most = yield point
        if here is None:
            return None
        for n in range(self.steps):
            step, promised = here.step()
            if self.fitted.cost - here.cost + promised < max(_HARDLY, _HOPELESS * most):
                # Not worth a simulation: the prediction of the step is enough.
                there = here.point.moved(here.point.shared + step, here.point.own)
                return Screened(variant, there, here.cost - promised, here.noise)
            # A first step along strongly correlated parameters may be too long for a linear model.
            for length in (1.0, 0.5, 0.25) if n == 0 else (1.0,):
                point = here.point.moved(here.point.shared + length * step, here.point.own)
                if sides is not None:
                    point = self.around.choose_sides(point, sides)
                there_to, most = yield point
                if there_to is not None and there_to.cost < here.cost:
                    break
            if there_to is None or there_to.cost >= here.cost:
                break
            gained, here = here.cost - there_to.cost, there_to
            if gained < max(0.5, 1e-3 * (self.fitted.cost - here.cost)):
                break
        return Screened(here.point.effects[-1], here.point, here.cost, here.noise)
