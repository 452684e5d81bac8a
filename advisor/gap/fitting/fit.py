"""Output error over several manoeuvres with any effects in the model: block-wise Gauss-Newton.

Shared parameters (derivatives and parameters of effects) are few. Every manoeuvre adds nuisance parameters:
initial state, trim, offsets and uncertain edges of the command. A Schur complement eliminates a manoeuvre's
own parameters, so the work is linear in the number of manoeuvres. The noise of each channel is re-estimated
at every step, which minimises det R of Eqs. (7)-(8) for a diagonal R.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.fitting.linear import Linear, are_near, linearise
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, counts, row_weights
from advisor.gap.fitting.step import SearchStep, solve_blocks
from advisor.gap.records.flights import PreparedManeuver
from advisor.process.arrays import FloatArray

_SETTLED = 0.02
"""Numerical: relative change of the weights at which the iteration of weights and nuisance parameters
ends."""
_SHORTER = 0.3
"""Numerical: factor by which a step that raises the cost is shortened."""
_SHORTEST = 0.05
"""Numerical: least length of a shortened step, relative to the full step. Below this length the simulation's
grid makes the cost rough."""
_FURTHER = 5.0
"""Numerical: upper bound of a search's further decrease of the cost, over the decrease that the next step
promises."""
_EDGES_DIFFER = 0.05
"""Numerical: root mean square shift of the command's edges, in intervals between stamps, above which the
model is linearised again before a search ends."""


@dataclass(frozen=True)
class EffectFit:
    """Result of a search for the least cost."""

    point: SearchPoint
    noise: FloatArray
    """Shape (channels,): standard deviation of the innovations."""
    cost: float
    """-2 log likelihood, profiled over the noise, plus the priors."""
    innovations: tuple[FloatArray, ...]
    """Per manoeuvre: residuals without offsets and edges, whitened by the filter of the noise."""
    residuals: tuple[FloatArray, ...]
    """Per manoeuvre: residuals without offsets and edges, in the units of the channels."""
    information: FloatArray
    """Shape (k, k): information on the shared parameters, with nuisance parameters eliminated."""
    linear: tuple[Linear, ...]
    iterations: int


def residual_noise(problem: EffectProblem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Return the root mean square of the residuals, at least the smallest noise, shape (channels,)."""
    return above_floor(problem, rms_of(problem, residuals))


def above_floor(problem: EffectProblem, noise: FloatArray) -> FloatArray:
    """Return the noise, at least the smallest noise, shape (channels,) or (k, channels)."""
    return np.maximum(noise, 1e-7 if problem.smallest_noise is None else problem.smallest_noise)


def rms_of(problem: EffectProblem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Return the root mean square of the residuals over all manoeuvres, shape (channels,)."""
    power, count = power_of(problem, residuals, lambda _, t: np.ones(len(t), bool))
    return np.asarray(np.sqrt(power / np.maximum(count, 1.0)))


def power_of(
    problem: EffectProblem,
    residuals: Sequence[FloatArray],
    picked: Callable[[PreparedManeuver, FloatArray], np.ndarray],
) -> tuple[FloatArray, FloatArray]:
    """Return the sums of squares and the numbers of the picked samples, shape (channels,) each.

    ``picked`` marks the samples of a manoeuvre at stamps (n,).
    """
    power, count = np.zeros(len(problem.channels)), np.zeros(len(problem.channels))
    for flight, residual in zip(problem.flights.flights, residuals, strict=True):
        for c, (name, rows) in enumerate(zip(problem.channels, problem.rows(flight), strict=True)):
            inside = residual[rows][picked(flight, flight.outputs[name].t)]
            power[c] += float(inside @ inside)
            count[c] += len(inside)
    return power, count


def cost_of(
    problem: EffectProblem,
    point: SearchPoint,
    residuals: Sequence[FloatArray],
    owns: Sequence[FloatArray],
    linear: Sequence[Linear],
) -> float:
    """Return -2 log likelihood profiled over the noise, Σ_c N_c log σ_c², plus the priors."""
    noise = residual_noise(problem, residuals)
    power = problem.prior_cost(point) + sum(
        float(np.sum(b.prior * (o - b.departure) ** 2)) for b, o in zip(linear, owns, strict=True)
    )
    return float(np.sum(counts(problem) * 2.0 * np.log(noise))) + power


def fit(
    problem: EffectProblem,
    start: SearchPoint,
    noise: FloatArray | None = None,
    iterations: int = 12,
    tolerance: float = 0.1,
    beaten_by: float = np.inf,
    aside: Collection[int] = (),
) -> EffectFit:
    """Minimise det R from a start. ``noise`` sets the weights of the first step.

    Parameters
    ----------
    beaten_by
        Cost of a rival fit: the search ends as soon as it cannot fall below that cost.
    aside
        Indices of manoeuvres that are left out of the cost.
    """
    linear = _without(linearise(problem, start), aside)
    weights = 1.0 / (residual_noise(problem, [b.residual for b in linear]) if noise is None else noise)
    kept = _settled(problem, start, linear, weights)
    length, done, answered_at = 1.0, 1, start
    while done < iterations and length > _SHORTEST:
        change = length * kept.step.shared
        promised = kept.step.promised(change)
        if (promised < tolerance and kept.has_its_edges) or kept.cost - _FURTHER * promised > beaten_by:
            break
        point = kept.point.moved(kept.point.shared + change, kept.point.own)
        point = problem.with_own(point, kept.step.owns(change))
        near = are_near(answered_at, point)
        linear = _without(linearise(problem, point, kept.linear if near else None), aside)
        here = _settled(problem, point, linear, kept.weights)
        done += 1
        if here.cost < kept.cost:
            kept, length, answered_at = here, 1.0, answered_at if near else point
        else:
            length *= _SHORTER
    still = np.zeros(len(kept.point.shared))
    measured = tuple(
        block.measured.after(still, own) for block, own in zip(kept.linear, kept.step.free, strict=True)
    )
    information = solve_blocks(problem, kept.linear, 1.0 / kept.noise, kept.point).information
    return EffectFit(
        kept.point, kept.noise, kept.cost, kept.residuals, measured, information, kept.linear, done
    )


def _edges_differ(search_point: SearchPoint, other: SearchPoint) -> bool:
    """Return whether the command's edges of two points differ. Unknown edges are placed at their stamps."""
    assert other.edges is not None
    there = np.concatenate(other.edges)
    shift = there if search_point.edges is None else there - np.concatenate(search_point.edges)
    return float(np.sum(shift**2)) > _EDGES_DIFFER**2 * len(shift)


def _without(linear: tuple[Linear, ...], aside: Collection[int]) -> tuple[Linear, ...]:
    """Return the linear model with zero residual and zero shared sensitivities in some manoeuvres."""
    return tuple(
        replace(block, columns=block.columns * (np.arange(block.columns.shape[1]) < block.m))
        if i in aside
        else block
        for i, block in enumerate(linear)
    )


@dataclass(frozen=True)
class _Place:
    """A simulated point, with the Gauss-Newton step from there."""

    point: SearchPoint
    """Point with the command's edges at their estimates."""
    has_its_edges: bool
    """Whether the estimated edges of the command are near those of the linearisation."""
    linear: tuple[Linear, ...]
    weights: FloatArray
    """Shape (channels,): weights of the model after the step."""
    step: SearchStep
    residuals: tuple[FloatArray, ...]
    """Per manoeuvre: residuals with nuisance parameters refitted."""
    noise: FloatArray
    cost: float


def _settled(
    problem: EffectProblem, point: SearchPoint, linear: tuple[Linear, ...], weights: FloatArray
) -> _Place:
    """Let weights and nuisance parameters converge at a fixed linearisation, which needs no simulation."""
    samples = np.maximum(counts(problem), 1.0)
    for _ in range(4):
        step = solve_blocks(problem, linear, weights, point)
        before, weights = weights, 1.0 / above_floor(problem, np.sqrt(step.squares_ahead(linear) / samples))
        if np.max(np.abs(np.log(weights / before))) < _SETTLED:
            break
    residuals = tuple(block.residual - block.own @ own for block, own in zip(linear, step.free, strict=True))
    cost = cost_of(problem, point, residuals, step.free, linear)
    there = replace(point, edges=problem.with_own(point, step.free).edges)
    noise, near = residual_noise(problem, residuals), not _edges_differ(point, there)
    return _Place(there, near, linear, weights, step, residuals, noise, cost)


def evidence_of(problem: EffectProblem, fitted: EffectFit) -> float:
    """Return -2 log marginal likelihood, up to a constant common to both readings of the command.

    The cost is increased by log det(I + Λ A_eᵀ W A_e), for the prior freedom of edges and air speeds.
    Parameters with a flat prior are eliminated.
    """
    total = fitted.cost
    for i, block in enumerate(fitted.linear):
        w = row_weights(problem, i, 1.0 / fitted.noise)[:, None]
        free = block.prior == 0.0
        if np.all(free):
            continue
        flat, edges = block.own[:, free] * w, block.own[:, ~free] * w
        q = np.linalg.qr(flat)[0]
        freed = (edges - q @ (q.T @ edges)) / np.sqrt(block.prior[~free])
        total += float(np.linalg.slogdet(np.eye(freed.shape[1]) + freed.T @ freed)[1])
    return total
