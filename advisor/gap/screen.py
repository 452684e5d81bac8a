"""Every candidate once, fast: the baseline's sensitivities are kept, only the effect's own are computed."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.belief import scale_of
from advisor.gap.fit import Fitted, bounds_of, factor, noise_of
from advisor.gap.linear import shared_steps
from advisor.gap.normal import solved
from advisor.gap.problem import Point, Problem, counts, row_weights
from advisor.gap.variant import Variant

_HARDLY = 6.0
"""Decrease of the cost (twice the log likelihood) below which a description is not followed any further."""


@dataclass(frozen=True)
class Screened:
    """A candidate after its quick fit."""

    variant: Variant
    point: Point
    cost: float
    """As ``Fitted.cost``, to compare with the baseline's."""
    noise: FloatArray
    belief: float = 0.0
    """Log probability gained because the derivatives agree better with the aircraft file's."""


@dataclass(frozen=True)
class _Kept:
    """Of one manoeuvre, weighted: own columns, shared columns, and what never changes between candidates."""

    A: FloatArray
    J: FloatArray
    chol: FloatArray
    AJ: FloatArray
    JJ: FloatArray


@dataclass(frozen=True)
class Place:
    """A point that was flown."""

    point: Point
    """With the manoeuvres' own numbers refitted."""
    flown: Point
    p: FloatArray
    grids: list[FloatArray]
    weighted: list[FloatArray]
    """Per manoeuvre: weighted innovations, own numbers not refitted."""
    cost: float
    noise: FloatArray


class Screen:
    """The baseline made ready for many candidates."""

    def __init__(self, problem: Problem, fitted: Fitted) -> None:
        self.problem, self.fitted = problem, fitted
        weights = 1.0 / fitted.noise
        self.weights = [row_weights(problem, i, weights) for i in range(len(problem.flights))]
        self.kept = []
        for i, block in enumerate(fitted.linear):
            A, J = block.own * self.weights[i][:, None], block.shared * self.weights[i][:, None]
            chol = factor(problem, i, block.own, block.prior, weights)
            AJ = A.T @ J
            self.kept.append(_Kept(A, J, chol, AJ, J.T @ J - AJ.T @ solved(chol, AJ)))
        self.count = counts(problem)
        self.plain: Place | None = None
        self.plain = self.at(fitted.point)

    def try_all(self, variants: list[Variant], believed: Callable[[Point], float]) -> list[Screened]:
        """Quick fits of all, the likeliest description of the data first.

        ``believed`` gives the log probability that a point gains from what the aircraft file says.
        """
        found = [
            replace(s, belief=believed(s.point)) for s in (self.try_one(v) for v in variants) if s is not None
        ]
        price = float(np.sum(self.count))
        return sorted(found, key=lambda s: s.cost - 2.0 * s.belief + penalty(s.variant, price))

    def try_one(self, variant: Variant, iterations: int = 4) -> Screened | None:
        """The best of a variant's starts."""
        found = [self._descend(variant, start, iterations) for start in variant.starts]
        return min((f for f in found if f is not None), key=lambda f: f.cost, default=None)

    def _descend(self, variant: Variant, start: tuple[float, ...], iterations: int) -> Screened | None:
        problem = self.problem
        sides = np.zeros(len(problem.flights)) if variant.sides is not None else None
        if variant.twin is not None and problem.believed is not None:
            point = self._at_the_files(variant)
        else:
            point = self.fitted.point.with_effect(variant, start, sides)
        if sides is not None:
            point = self.choose_sides(point, variant)
        here = self.at(point)
        if here is None:
            return None
        lower, upper = bounds_of(point)
        for n in range(iterations):
            step, promised = self._step(here)
            if self.fitted.cost - here.cost + promised < _HARDLY:
                # Not worth a flight: what the model says of the step is answer enough.
                shared = np.clip(here.point.shared + step, lower, upper)
                return Screened(
                    variant, here.point.moved(shared, here.point.own), here.cost - promised, here.noise
                )
            # A first step along numbers that nearly mimic each other may be too long for a linear model.
            for length in (1.0, 0.5, 0.25) if n == 0 else (1.0,):
                shared = np.clip(here.point.shared + length * step, lower, upper)
                point = here.point.moved(shared, here.point.own)
                if sides is not None:
                    point = self.choose_sides(point, variant)
                there = self.at(point)
                if there is not None and there.cost < here.cost:
                    break
            if there is None or there.cost >= here.cost:
                break
            gained, here = here.cost - there.cost, there
            if gained < max(0.5, 1e-3 * (self.fitted.cost - here.cost)):
                break
        return Screened(here.point.effects[-1], here.point, here.cost, here.noise)

    def _at_the_files(self, variant: Variant) -> Point:
        """The same motion with the effect in it, as near to the file's derivatives as it comes."""
        plain, believed = self.fitted.point, self.problem.believed
        assert variant.twin is not None
        assert believed is not None
        per_unit = variant.twin(plain.derivatives, plain.effects, self.problem.flights.reference_m_s)
        scale = scale_of(believed)
        change, missed = per_unit[: len(believed)] / scale, (believed - plain.derivatives) / scale
        value = float(np.clip(change @ missed / (change @ change), *variant.bounds[0]))
        return plain.moved(plain.shared + value * per_unit, plain.own).with_effect(variant, (value,))

    def at(self, point: Point) -> "Place | None":
        """Fly there, the manoeuvres' own numbers refitted with the baseline's sensitivities."""
        problem = self.problem
        p = problem.driving(point)
        grids, weighted, after, owns = [], [], [], []
        power = problem.disbelief(point)
        for i, kept in enumerate(self.kept):
            if self.plain is not None and np.array_equal(p[i], self.plain.p[i]):
                grid, r = self.plain.grids[i], self.plain.weighted[i]
            else:
                left, grid = problem.parts(i, p[i])
                if not np.all(np.isfinite(left)):
                    return None
                r = problem.innovations(i, left[:, None])[:, 0] * self.weights[i]
            own = solved(kept.chol, kept.A.T @ r)
            after.append((r - kept.A @ own) / self.weights[i])
            power += float(np.sum(self.fitted.linear[i].prior * own**2))
            grids.append(grid)
            weighted.append(r)
            owns.append(own[:4])
        noise = noise_of(problem, after)
        cost = float(np.sum(self.count * 2.0 * np.log(noise))) + power
        return Place(
            point.moved(point.shared, point.own + np.array(owns)), point, p, grids, weighted, cost, noise
        )

    def _step(self, here: "Place") -> tuple[FloatArray, float]:
        """Step of all shared numbers, and the decrease of the cost that it promises.

        The baseline's numbers keep their sensitivities, the effect's get new ones.
        """
        problem, flown = self.problem, here.flown
        k = len(self.fitted.point.shared)
        ke = len(flown.shared) - k
        extra = self._effect_columns(here, range(k, k + ke))
        pull, missed = problem.pull(flown)
        H, g = np.diag(pull), pull * missed
        for i, kept in enumerate(self.kept):
            X = np.column_stack([extra[i], here.weighted[i]])
            AX = kept.A.T @ X
            GX = solved(kept.chol, AX)
            XX = X.T @ X - AX.T @ GX
            JX = kept.J.T @ X - kept.AJ.T @ GX
            H[:k, :k] += kept.JJ
            H[:k, k:] += JX[:, :ke]
            H[k:, :k] += JX[:, :ke].T
            H[k:, k:] += XX[:ke, :ke]
            g[:k] += JX[:, ke]
            g[k:] += XX[:ke, ke]
        scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
        normal = H / np.outer(scale, scale) + 1e-9 * np.eye(k + ke)
        step = np.linalg.lstsq(normal, g / scale, rcond=1e-12)[0] / scale
        return step, float(g @ step)

    def _effect_columns(self, here: "Place", which: range) -> list[FloatArray]:
        """Weighted sensitivities to an effect's parameters.

        A change of derivatives from one manoeuvre to the next is a sum of sensitivities known already,
        and none at all in manoeuvres it does not touch: nothing is flown for it.
        """
        problem, point = self.problem, here.flown
        steps = shared_steps(point)
        columns = [np.zeros((len(kept.J), len(which))) for kept in self.kept]
        for j, index in enumerate(which):
            shifted = point.shared.copy()
            shifted[index] += steps[index]
            q = problem.driving(point.moved(shifted, point.own))
            for i, (flight, kept) in enumerate(zip(problem.flights.flights, self.kept, strict=True)):
                change = (q[i] - here.p[i]) / steps[index]
                if not np.any(change[6:]):
                    columns[i][:, j] = kept.J[:, :6] @ change[:6]
                    continue
                moved = problem.read(flight, problem.fly(flight, q[i]), q[i])
                raw = (moved - problem.read(flight, here.grids[i], here.p[i])) / steps[index]
                columns[i][:, j] = problem.innovations(i, raw[:, None])[:, 0] * self.weights[i]
        return columns

    def choose_sides(self, point: Point, variant: Variant) -> Point:
        """In every manoeuvre the side that leaves least, own numbers refitted."""
        assert variant.sides is not None
        best_cost = np.full(len(self.kept), np.inf)
        best_side = np.zeros(len(self.kept))
        for side in variant.sides[1]:
            p = self.problem.driving(replace(point, sides=np.full(len(self.kept), side)))
            for i, kept in enumerate(self.kept):
                left = self.problem.parts(i, p[i])[0][:, None]
                r = self.problem.innovations(i, left)[:, 0] * self.weights[i]
                Ar = kept.A.T @ r
                cost = float(r @ r - Ar @ solved(kept.chol, Ar))
                if cost < best_cost[i]:
                    best_cost[i], best_side[i] = cost, side
        return replace(point, sides=best_side)


def penalty(variant: Variant, samples: float) -> float:
    """k ln N: what a description must gain per number it adds (Schwarz)."""
    steps = 1 if variant.fixed else 0
    return (len(variant.names) + steps) * float(np.log(max(samples, 2.0)))
