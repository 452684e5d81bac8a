"""Fast evaluation of many parameter points around a fitted model, from the sensitivities of the fit.

Only the sensitivities to the effect added last are computed anew. Many points are simulated together, so that
they share SIMD packs (``advisor.gap.simulator.simulate``). Only differences to the fitted model matter, so a
coarser time grid suffices.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.fitting.fit import EffectFit, above_floor
from advisor.gap.fitting.linear import shared_steps, shifted_points
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, counts, row_weights
from advisor.gap.fitting.step import bounds_of, factor_of
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.simulator.reading import differences
from advisor.oem.arrow import solved, solved_within
from advisor.process.arrays import FloatArray

_INDIFFERENT = 1e-9
"""Numerical: relative information below which a direction of the shared parameters is not moved in a quick
fit."""


@dataclass(frozen=True)
class SimulatedPoint:
    """A simulated point near the fitted model."""

    point: SearchPoint
    """Point with the nuisance parameters refitted."""
    cost: float
    noise: FloatArray
    information: FloatArray
    """Shape (k, k): information on all shared parameters, with nuisance parameters eliminated."""
    gradient: FloatArray
    """Shape (k,): half the decrease of the cost per unit of each shared parameter."""

    def step(self) -> tuple[FloatArray, float]:
        """Return the step of all shared parameters within their bounds, and the promised decrease of the
        cost."""
        lower, upper = bounds_of(self.point)
        shared, H, g = self.point.shared, self.information, self.gradient
        step = solved_within(H, g, lower - shared, upper - shared, _INDIFFERENT)
        return step, float(2.0 * g @ step - step @ H @ step)


@dataclass(frozen=True)
class _Kept:
    """Weighted quantities of one manoeuvre that are equal at all parameter points."""

    flight: PreparedManeuver
    """The prepared manoeuvre, sampled on a coarser time grid."""
    measured: FloatArray
    """Shape (rows,): outputs of the fitted model on the coarser grid, plus the residuals of the fit."""
    weights: FloatArray
    """Shape (rows,): weight of each row."""
    columns: FloatArray
    """Shape (rows, m + k + 1): sensitivities to nuisance and shared parameters, and the fit's residual."""
    products: FloatArray
    """Shape (channels, m + k + 1, m + k + 1): inner products of the columns, by channel."""
    inner: FloatArray
    """Shape (m + k + 1, m + k + 1): inner products of the columns over all channels."""
    m: int
    chol: FloatArray

    @property
    def own(self) -> FloatArray:
        """Shape (rows, m): sensitivities to the nuisance parameters."""
        return self.columns[:, : self.m]

    @property
    def still(self) -> list[int]:
        """Indices of the columns that need no simulation: sensitivities to the derivatives, and the
        residual."""
        return [*range(self.m, self.m + len(DERIVATIVES)), self.columns.shape[1] - 1]


@dataclass(frozen=True)
class _Flown:
    """Simulated columns of one manoeuvre for many parameter points."""

    columns: FloatArray
    """Shape (rows, columns): weighted innovations and their sensitivities."""
    at: list[int]
    """Index of each column among the columns of all points."""
    points: list[tuple[int, slice]]
    """Index of each point with its columns: first the innovation, then the sensitivities."""


@dataclass(frozen=True)
class _Asked:
    """A parameter point to be simulated, and its columns among those of all points."""

    point: SearchPoint
    p: FloatArray
    """Shape (manoeuvres, entries): simulator inputs of the point."""
    shifted: FloatArray
    """Shape (parameters, manoeuvres, entries): simulator inputs with each parameter of the last effect moved
    by its step."""
    steps: FloatArray
    """Shape (parameters,): finite-difference steps of the last effect's parameters."""
    changes: FloatArray
    """Shape (parameters, manoeuvres, 6): change of the derivatives per unit of each parameter."""
    flown: np.ndarray
    """Shape (parameters, manoeuvres), bool: whether the parameter changes more than derivatives."""
    moved: np.ndarray
    """Shape (manoeuvres,), bool: whether the manoeuvre needs a simulation."""
    first: int
    """Index of the innovation's column, before the columns of the parameters."""

    @property
    def columns(self) -> slice:
        """Range of all columns of the point."""
        return slice(self.first, self.first + 1 + len(self.steps))


class Neighbourhood:
    """A fitted model prepared for the evaluation of many points."""

    def __init__(self, problem: EffectProblem, fitted: EffectFit) -> None:
        self.problem, self.fitted = problem, fitted
        weights = 1.0 / fitted.noise
        self.kept = []
        self.p = problem.driving(fitted.point)
        self.count = counts(problem)
        k = len(fitted.point.shared)
        self.information = np.zeros((k, k))
        for i, (flight, block) in enumerate(zip(problem.flights.flights, fitted.linear, strict=True)):
            coarser, by_row, m = flight.coarser(), row_weights(problem, i, weights), block.m
            measured = problem.fly_and_read(coarser, self.p[i : i + 1])[:, 0] + block.measured.residual
            products = block.products * weights[:, None, None] ** 2
            inner = np.sum(products, axis=0)
            chol = factor_of(inner[:m, :m].copy(), block.prior)
            across = inner[:m, m : m + k]
            self.information += inner[m : m + k, m : m + k] - across.T @ solved(chol, across)
            columns = block.columns * by_row[:, None]
            self.kept.append(_Kept(coarser, measured, by_row, columns, products, inner, m, chol))

    def at_all(self, points: Sequence[SearchPoint]) -> list[SimulatedPoint | None]:
        """Evaluate every point with refitted nuisance parameters; the entry is None if the simulation
        fails."""
        problem = self.problem
        asked: list[_Asked] = []
        for point in points:
            asked.append(self._asked(point, asked[-1].columns.stop if asked else 0))
        firsts, width = [a.first for a in asked], asked[-1].columns.stop
        failed = np.zeros(len(asked), dtype=bool)
        squares, prior = np.zeros((len(self.count), len(asked))), np.zeros(len(asked))
        JX = np.zeros((len(self.information), width))
        XX = np.zeros((width, width))
        owns: list[FloatArray] = []
        for i, kept in enumerate(self.kept):
            still = _still(i, asked, width)
            flown = self._flown(i, asked, failed)
            along = np.array(
                [kept.columns[rows].T @ flown.columns[rows] for rows in problem.rows(kept.flight)]
            )
            # Columns without a simulation are sums of known columns, so their inner products are known too.
            CX = kept.inner[:, kept.still] @ still
            CX[:, flown.at] = np.sum(along, axis=0)
            m, shared = kept.m, slice(kept.m, kept.m + len(JX))
            AX = CX[:m]
            linear = self.fitted.linear[i]
            AX[:, firsts] += (linear.prior * linear.departure)[:, None]
            GX = solved(kept.chol, AX)
            JX += CX[shared] - kept.inner[:m, shared].T @ GX
            XX += _with_one_another(still, CX[kept.still], flown) - AX.T @ GX
            own = GX[:, firsts]
            prior += linear.prior @ (own - linear.departure[:, None]) ** 2
            squares += self._squares(kept, flown, along, own)
            owns.append(own.T)
        noise = above_floor(problem, np.sqrt(squares / np.maximum(self.count, 1.0)[:, None]).T)
        costs = 2.0 * np.log(noise) @ self.count + prior
        return [
            None
            if failed[j]
            else self._place(
                a, costs[j], noise[j], [own[j] for own in owns], JX[:, a.columns], XX[a.columns, a.columns]
            )
            for j, a in enumerate(asked)
        ]

    def _squares(self, kept: _Kept, flown: _Flown, along: FloatArray, own: FloatArray) -> FloatArray:
        """Return sums of squares of one manoeuvre's residuals after the refit, shape (channels, points)."""
        m, points = kept.m, own.shape[1]
        Ar = np.repeat(kept.products[:, :m, -1:], points, axis=2)
        rr = np.repeat(kept.products[:, -1, -1:], points, axis=1)
        of, begin = [j for j, _ in flown.points], [run.start for _, run in flown.points]
        Ar[:, :, of] = along[:, :m, begin]
        rows = self.problem.rows(kept.flight)
        residual = flown.columns[:, begin]
        rr[:, of] = [np.einsum("ij,ij->j", residual[r], residual[r]) for r in rows]
        after = rr + np.sum(own * (kept.products[:, :m, :m] @ own - 2.0 * Ar), axis=1)
        return np.asarray(np.maximum(after, 0.0) * self.fitted.noise[:, None] ** 2)

    def _asked(self, point: SearchPoint, first: int) -> _Asked:
        n, k = len(self.information), len(DERIVATIVES)
        steps = shared_steps(point)[n:]
        p = self.problem.driving(point)
        there = shifted_points(point, range(n, n + len(steps)))
        shifted = np.array([self.problem.driving(at) for at in there]).reshape(len(steps), *p.shape)
        flown = np.any(shifted[:, :, k:] != p[:, k:], axis=2)
        moved = np.any(flown, axis=0) | np.any(p != self.p, axis=1)
        changes = (shifted[:, :, :k] - p[:, :k]) / steps[:, None, None]
        return _Asked(point, p, shifted, steps, changes, flown, moved, first)

    def _place(
        self,
        a: _Asked,
        cost: float,
        noise: FloatArray,
        owns: Sequence[FloatArray],
        JX: FloatArray,
        XX: FloatArray,
    ) -> SimulatedPoint:
        precision, departure = self.problem.prior_of(a.point)
        n = len(self.information)
        H, g = np.diag(precision), precision * departure
        H[:n, :n] += self.information
        H[:n, n:] += JX[:, 1:]
        H[n:, :n] += JX[:, 1:].T
        H[n:, n:] += XX[1:, 1:]
        g += np.concatenate([JX[:, 0], XX[1:, 0]])
        there = self.problem.with_own(a.point, owns)
        return SimulatedPoint(there, float(cost + precision @ departure**2), noise, H, g)

    def _flown(self, i: int, asked: Sequence[_Asked], failed: np.ndarray) -> _Flown:
        """Simulate manoeuvre ``i`` at those points whose response no sum of sensitivities gives."""
        problem, kept = self.problem, self.kept[i]
        rows: list[FloatArray] = []
        base, step, at, points = [], [], [], []
        for j, a in enumerate(asked):
            if not a.moved[i]:
                continue
            flown = np.flatnonzero(a.flown[:, i])
            points.append((j, slice(len(rows), len(rows) + 1 + len(flown))))
            base += [len(rows)] * (1 + len(flown))
            at += [a.first, *(a.first + 1 + flown)]
            step += [0.0, *a.steps[flown]]
            rows += [a.p[i], *a.shifted[flown, i]]
        if not rows:
            return _Flown(np.zeros((len(kept.weights), 0)), at, points)
        read = problem.fly_and_read(kept.flight, np.array(rows))
        finite = np.isfinite(np.sum(read, axis=0))
        read[:, ~finite] = 0.0
        for j, run in points:
            failed[j] |= not finite[run.start]
        raw = differences(read, kept.measured, np.array(base), np.array(step))
        return _Flown(problem.innovations(i, raw) * kept.weights[:, None], at, points)

    def choose_sides(self, point: SearchPoint, entries: Sequence[float]) -> SearchPoint:
        """Return the point with the sign of the effect that leaves the least residual in each manoeuvre."""
        problem = self.problem
        p = [problem.driving(replace(point, sides=np.full(len(self.kept), side))) for side in entries]
        best = []
        for i, kept in enumerate(self.kept):
            rows = np.stack([q[i] for q in p])
            residual = kept.measured[:, None] - problem.fly_and_read(kept.flight, rows)
            r = problem.innovations(i, residual) * kept.weights[:, None]
            linear = self.fitted.linear[i]
            Ar = kept.own.T @ r + (linear.prior * linear.departure)[:, None]
            costs = np.sum(r * r, axis=0) - np.sum(Ar * solved(kept.chol, Ar), axis=0)
            # Without play all sides are equal but for rounding, and the first is taken.
            best.append(entries[int(np.argmax(costs <= np.min(costs) * (1.0 + 1e-9)))])
        return replace(point, sides=np.array(best))


def _still(i: int, asked: Sequence[_Asked], width: int) -> FloatArray:
    """Return every column of manoeuvre ``i`` as a sum of those that need no simulation, shape (7, width)."""
    k = len(DERIVATIVES)
    still = np.zeros((k + 1, width))
    for a in asked:
        still[k, a.first] = 1.0
        still[:k, a.first + 1 : a.columns.stop] = a.changes[:, i].T
    return still


def _with_one_another(still: FloatArray, columns: FloatArray, flown: _Flown) -> FloatArray:
    """Return inner products of the columns within each point, shape (width, width)."""
    XX = still.T @ columns
    XX[flown.at] = XX[:, flown.at].T
    both = np.zeros((len(flown.at), len(flown.at)))
    for _, run in flown.points:
        both[run, run] = flown.columns[:, run].T @ flown.columns[:, run]
    XX[np.ix_(flown.at, flown.at)] = both
    return XX
