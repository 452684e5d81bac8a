"""Output error over several manoeuvres with any effects in the model: Gauss-Newton by blocks.

Shared numbers (derivatives, parameters of effects) are few; every manoeuvre adds its own initial
state, trim, offsets and uncertain edges of the command, which are eliminated manoeuvre by manoeuvre
(a Schur complement), so the cost is linear in manoeuvres. The noise of each channel is re-estimated
at every step, which minimises det R of Eqs. (7)-(8) for a diagonal R.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.layout import NUISANCES
from advisor.gap.linear import (
    Linear,
    linearise,
)
from advisor.gap.normal import factored, solved
from advisor.gap.problem import Point, Problem, counts, row_weights

_SETTLED = 0.02
"""Relative change of the weights below which they and the own numbers have settled together."""


@dataclass(frozen=True)
class Fitted:
    """Where the search ended."""

    point: Point
    noise: FloatArray
    """Shape (channels,): standard deviation of the innovations."""
    cost: float
    """-2 log likelihood, profiled over the noise, priors included."""
    innovations: tuple[FloatArray, ...]
    """Per manoeuvre, what is left after offsets and edges, freed of what neighbours have in common."""
    left: tuple[FloatArray, ...]
    """The same in the units of the channels."""
    information: FloatArray
    """Shape (k, k): of the shared numbers, own numbers eliminated."""
    linear: tuple[Linear, ...]
    iterations: int


def factor(problem: Problem, i: int, own: FloatArray, prior: FloatArray, weights: FloatArray) -> FloatArray:
    """Cholesky factor of AᵀWA + Λ⁻¹ for one manoeuvre's own columns."""
    weighted = own * row_weights(problem, i, weights)[:, None]
    normal = weighted.T @ weighted + np.diag(prior)
    normal[np.diag_indices_from(normal)] *= 1.0 + 1e-10
    normal[np.diag_indices_from(normal)] += 1e-12 * np.trace(normal) / len(normal)
    return factored(normal)


def solve_blocks(
    problem: Problem, linear: Sequence[Linear], weights: FloatArray, damping: float, derivatives: FloatArray
) -> tuple[FloatArray, list[FloatArray], FloatArray, list[FloatArray]]:
    """One Gauss-Newton step.

    Returns
    -------
    Step of the shared numbers (k,), per manoeuvre the own numbers' solution (m,), the information
    matrix (k, k), and per manoeuvre the predicted residual after the step.
    """
    k = linear[0].shared.shape[1]
    H, g = np.zeros((k, k)), np.zeros(k)
    H[:6, :6], g[:6] = np.diag(problem.pull), problem.pull * problem.missed(derivatives)
    kept = []
    for i, block in enumerate(linear):
        w = row_weights(problem, i, weights)
        A, J, r = block.own * w[:, None], block.shared * w[:, None], block.left * w
        chol = factor(problem, i, block.own, block.prior, weights)
        AJ, Ar = A.T @ J, A.T @ r
        eliminated = solved(chol, np.column_stack([AJ, Ar]))
        H += J.T @ J - AJ.T @ eliminated[:, :k]
        g += J.T @ r - AJ.T @ eliminated[:, k]
        kept.append(eliminated)
    scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
    normal = H / np.outer(scale, scale)
    step = np.linalg.lstsq(normal + damping * np.eye(k), g / scale, rcond=1e-12)[0] / scale
    owns, lefts = [], []
    for block, eliminated in zip(linear, kept, strict=True):
        own = eliminated[:, k] - eliminated[:, :k] @ step
        owns.append(own)
        lefts.append(block.after(step, own))
    return step, owns, H, lefts


def noise_of(problem: Problem, lefts: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,): RMS of what is left, not below the smallest noise."""
    noise = rms_of(problem, lefts)
    return np.maximum(noise, 1e-7 if problem.smallest_noise is None else problem.smallest_noise)


def rms_of(problem: Problem, lefts: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,): root mean square over all manoeuvres."""
    power, count = np.zeros(len(problem.channels)), np.zeros(len(problem.channels))
    for flight, left in zip(problem.flights.flights, lefts, strict=True):
        for c, rows in enumerate(problem.rows(flight)):
            power[c] += float(left[rows] @ left[rows])
            count[c] += rows.stop - rows.start
    return np.asarray(np.sqrt(power / np.maximum(count, 1.0)))


def cost_of(
    problem: Problem,
    point: Point,
    lefts: Sequence[FloatArray],
    owns: Sequence[FloatArray],
    linear: Sequence[Linear],
) -> float:
    """-2 log likelihood profiled over the noise, Σ_c N_c log σ_c², plus the priors."""
    noise = noise_of(problem, lefts)
    power = problem.disbelief(point.derivatives) + sum(
        float(np.sum(b.prior * o**2)) for b, o in zip(linear, owns, strict=True)
    )
    return float(np.sum(counts(problem) * 2.0 * np.log(noise))) + power


def fit(
    problem: Problem,
    start: Point,
    noise: FloatArray | None = None,
    iterations: int = 12,
    tolerance: float = 0.02,
) -> Fitted:
    """Minimise det R from a start. The first noise decides the weights of the first step."""
    point = start
    linear = linearise(problem, point)
    weights = 1.0 / (noise_of(problem, [b.left for b in linear]) if noise is None else noise)
    lower, upper = bounds_of(point)
    damping, best = 0.0, np.inf
    information = np.eye(len(point.shared))
    lefts: list[FloatArray] = [b.left for b in linear]
    done = 0
    kept: tuple[Point, tuple[Linear, ...]] = (point, linear)
    while done < iterations:
        done += 1
        # Weights and own numbers settle together at a fixed linearisation: cheap, no simulation.
        for _ in range(4):
            step, owns, information, lefts = solve_blocks(
                problem, linear, weights, damping, point.derivatives
            )
            before, weights = weights, 1.0 / noise_of(problem, lefts)
            if np.max(np.abs(np.log(weights / before))) < _SETTLED:
                break
        owns_here, left_here = own_only(problem, linear, weights)
        here = cost_of(problem, point, left_here, owns_here, linear)
        if here < best + 1e-9:
            gained = best - here
            best, kept = here, (point, linear)
            damping = damping / 10.0 if damping > 1e-6 else 0.0
            if gained < tolerance:
                break
        else:
            damping = max(10.0 * damping, 1e-3)
            point, linear = kept
            if damping > 1e3:
                break
            step, owns, information, lefts = solve_blocks(
                problem, linear, weights, damping, point.derivatives
            )
        shared = np.clip(point.shared + step, lower, upper)
        own = point.own + np.array([o[: len(NUISANCES)] for o in owns])
        point = point.moved(shared, own)
        linear = linearise(problem, point)
    point, linear = kept
    owns_here, left_here = own_only(problem, linear, weights)
    _, _, information, _ = solve_blocks(
        problem, linear, 1.0 / noise_of(problem, left_here), 0.0, point.derivatives
    )
    still = np.zeros(len(point.shared))
    measured = tuple(block.measured.after(still, own) for block, own in zip(linear, owns_here, strict=True))
    return Fitted(
        point, noise_of(problem, left_here), best, tuple(left_here), measured, information, linear, done
    )


def own_only(
    problem: Problem, linear: Sequence[Linear], weights: FloatArray
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Own numbers and residuals of every manoeuvre at fixed shared numbers."""
    owns, lefts = [], []
    for i, block in enumerate(linear):
        w = row_weights(problem, i, weights)
        chol = factor(problem, i, block.own, block.prior, weights)
        own = solved(chol, (block.own * w[:, None]).T @ (block.left * w))
        owns.append(own)
        lefts.append(block.left - block.own @ own)
    return owns, lefts


def bounds_of(point: Point) -> tuple[FloatArray, FloatArray]:
    """Lower and upper bounds of the shared numbers."""
    free = np.full(len(point.derivatives), np.inf)
    lower = np.concatenate([-free, *[np.array([b[0] for b in e.bounds]) for e in point.effects]])
    upper = np.concatenate([free, *[np.array([b[1] for b in e.bounds]) for e in point.effects]])
    return lower, upper


def evidence_of(problem: Problem, fitted: Fitted) -> float:
    """-2 log marginal likelihood, up to what two ways of reading the command have in common.

    The cost, plus the price of the edges' freedom: log det(I + Λ A_eᵀ W A_e), flat numbers eliminated.
    """
    total = fitted.cost
    for i, block in enumerate(fitted.linear):
        w = row_weights(problem, i, 1.0 / fitted.noise)[:, None]
        free = block.prior == 0.0
        if np.all(free):
            continue
        flat, edges = block.own[:, free] * w, block.own[:, ~free] * w
        q = np.linalg.qr(flat)[0]
        left = (edges - q @ (q.T @ edges)) / np.sqrt(block.prior[~free])
        total += float(np.linalg.slogdet(np.eye(left.shape[1]) + left.T @ left)[1])
    return total
