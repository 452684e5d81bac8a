"""Every candidate once, fast: the baseline's sensitivities are kept, only the effect's own are computed."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve

from advisor.flight.messages import FloatArray
from advisor.gap.fit import Fitted, bounds_of, factor, noise_of
from advisor.gap.linear import shared_columns
from advisor.gap.problem import Point, Problem, counts, row_weights
from advisor.gap.variant import Variant


@dataclass(frozen=True)
class Screened:
    """A candidate after its quick fit."""

    variant: Variant
    point: Point
    cost: float
    """As ``Fitted.cost``, to compare with the baseline's."""
    noise: FloatArray


@dataclass(frozen=True)
class _Kept:
    """Of one manoeuvre, weighted: own columns, shared columns, and what never changes between candidates."""

    A: FloatArray
    J: FloatArray
    chol: tuple[FloatArray, bool]
    AJ: FloatArray
    JJ: FloatArray


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
            self.kept.append(_Kept(A, J, chol, AJ, J.T @ J - AJ.T @ cho_solve(chol, AJ)))
        self.count = counts(problem)

    def try_all(self, variants: list[Variant]) -> list[Screened]:
        """Quick fits of all, cheapest description of the data first."""
        found = [s for s in (self.try_one(v) for v in variants) if s is not None]
        return sorted(found, key=lambda s: s.cost + penalty(s.variant, float(np.sum(self.count))))

    def try_one(self, variant: Variant, iterations: int = 4) -> Screened | None:
        """The best of a variant's starts."""
        best: Screened | None = None
        for start in variant.starts:
            here = self._descend(variant, start, iterations)
            if here is not None and (best is None or here.cost < best.cost):
                best = here
        return best

    def _descend(self, variant: Variant, start: tuple[float, ...], iterations: int) -> Screened | None:
        problem = self.problem
        sides = np.zeros(len(problem.flights)) if variant.sides is not None else None
        point = self.fitted.point.with_effect(variant, start, sides)
        if sides is not None:
            point = self.choose_sides(point, variant)
        lower, upper = bounds_of(point)
        k, ke = len(self.fitted.point.shared), len(variant.names)
        best: Screened | None = None
        for n in range(iterations):
            p = problem.driving(point)
            lefts, grids = zip(*[problem.parts(i, p[i]) for i in range(len(problem.flights))], strict=True)
            if not all(np.all(np.isfinite(left)) for left in lefts):
                return best
            own_steps, shared_step, here = self._solve(point, p, lefts, grids, k, ke)
            if best is None or here.cost < best.cost:
                gained = np.inf if best is None else best.cost - here.cost
                best = here
                if gained < max(0.5, 1e-3 * (self.fitted.cost - here.cost)):
                    break
            else:
                break
            if n < iterations - 1:
                shared = np.clip(point.shared + shared_step, lower, upper)
                point = point.moved(shared, point.own + own_steps)
                if sides is not None:
                    point = self.choose_sides(point, variant)
        return best

    def _solve(
        self,
        point: Point,
        p: FloatArray,
        lefts: tuple[FloatArray, ...],
        grids: tuple[FloatArray, ...],
        k: int,
        ke: int,
    ) -> tuple[FloatArray, FloatArray, Screened]:
        problem = self.problem
        extra = shared_columns(problem, point, p, grids, range(k, k + ke))
        H, g = np.zeros((k + ke, k + ke)), np.zeros(k + ke)
        solved = []
        for i, kept in enumerate(self.kept):
            w = self.weights[i][:, None]
            X = np.column_stack([extra[i], lefts[i]]) * w
            AX = kept.A.T @ X
            GX = cho_solve(kept.chol, AX)
            XX = X.T @ X - AX.T @ GX
            JX = kept.J.T @ X - kept.AJ.T @ GX
            H[:k, :k] += kept.JJ
            H[:k, k:] += JX[:, :ke]
            H[k:, :k] += JX[:, :ke].T
            H[k:, k:] += XX[:ke, :ke]
            g[:k] += JX[:, ke]
            g[k:] += XX[:ke, ke]
            solved.append((X, GX))
        scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
        step = (
            np.linalg.lstsq(H / np.outer(scale, scale) + 1e-9 * np.eye(k + ke), g / scale, rcond=1e-12)[0]
            / scale
        )
        # Hold the step of a pinned parameter at its bound, so that the predicted residual is honest.
        lower, upper = bounds_of(point)
        step = np.clip(point.shared + step, lower, upper) - point.shared
        after, owns = [], []
        for i, kept in enumerate(self.kept):
            X, GX = solved[i]
            own = GX[:, ke] - GX[:, :ke] @ step[k:] - cho_solve(kept.chol, kept.AJ @ step[:k])
            left = X[:, ke] - X[:, :ke] @ step[k:] - kept.J @ step[:k] - kept.A @ own
            after.append(left / self.weights[i])
            owns.append(own)
        noise = noise_of(problem, after)
        power = sum(float(np.sum(b.prior * o**2)) for b, o in zip(self.fitted.linear, owns, strict=True))
        cost = float(np.sum(self.count * 2.0 * np.log(noise))) + power
        moved = point.moved(point.shared + step, point.own + np.array([o[:4] for o in owns]))
        return np.array([o[:4] for o in owns]), step, Screened(point.effects[-1], moved, cost, noise)

    def choose_sides(self, point: Point, variant: Variant) -> Point:
        """In every manoeuvre the side that leaves least, own numbers refitted."""
        assert variant.sides is not None
        best_cost = np.full(len(self.kept), np.inf)
        best_side = np.zeros(len(self.kept))
        for side in variant.sides[1]:
            p = self.problem.driving(replace(point, sides=np.full(len(self.kept), side)))
            for i, kept in enumerate(self.kept):
                r = self.problem.parts(i, p[i])[0] * self.weights[i]
                Ar = kept.A.T @ r
                cost = float(r @ r - Ar @ cho_solve(kept.chol, Ar))
                if cost < best_cost[i]:
                    best_cost[i], best_side[i] = cost, side
        return replace(point, sides=best_side)


def penalty(variant: Variant, samples: float) -> float:
    """k ln N: what a description must gain per number it adds (Schwarz)."""
    steps = 1 if variant.fixed else 0
    return (len(variant.names) + steps) * float(np.log(max(samples, 2.0)))
