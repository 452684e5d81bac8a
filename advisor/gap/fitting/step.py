"""One Gauss-Newton step: nuisance parameters are eliminated, and shared parameters stay within bounds.

The inner products of the columns are known, so a step with other weights is cheap.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.fitting.linear import Linear
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.oem.arrow import factored, solved, solved_within
from advisor.process.arrays import FloatArray

_FASTEST_GROWTH = 5.0
"""Prior: largest growth rate of an unstable motion, 1/s: the amplitude doubles in 0.14 s, as on the most
unstable aircraft with computer control. A fit with faster growth has diverged from the measured motion."""
_GROWS = {"Z_alpha": _FASTEST_GROWTH, "M_q": _FASTEST_GROWTH, "M_alpha": _FASTEST_GROWTH**2}
"""Prior: largest value of each derivative at which the motion grows at ``_FASTEST_GROWTH``."""
_MOST = np.array([_GROWS.get(name, np.inf) for name in DERIVATIVES])
"""Shape (6,): largest value of each derivative that alone lets the motion grow at ``_FASTEST_GROWTH``."""


def factor(A: FloatArray, prior: FloatArray) -> FloatArray:
    """Return the Cholesky factor of AᵀA + Λ⁻¹ for the weighted nuisance columns of one manoeuvre."""
    return factor_of(A.T @ A, prior)


def factor_of(normal: FloatArray, prior: FloatArray) -> FloatArray:
    """Return the Cholesky factor of AᵀA + Λ⁻¹ from the product AᵀA, shape (m, m), which is overwritten."""
    diagonal = normal.diagonal() + prior
    np.fill_diagonal(normal, diagonal * (1.0 + 1e-10) + 1e-12 * diagonal.sum() / len(diagonal))
    return factored(normal)


@dataclass(frozen=True)
class SearchStep:
    """A Gauss-Newton step from the point of the linearisation."""

    shared: FloatArray
    """Shape (k,): step of the shared parameters, within their bounds."""
    free: list[FloatArray]
    """Per manoeuvre, shape (m,): nuisance parameters without a step of the shared parameters."""
    follow: list[FloatArray]
    """Per manoeuvre, shape (m, k): decrease of the nuisance parameters per unit of each shared parameter."""
    information: FloatArray
    """Shape (k, k): information on the shared parameters."""
    gradient: FloatArray
    """Shape (k,): half the decrease of the cost per unit of each shared parameter."""

    def promised(self, shared: FloatArray) -> float:
        """Return the decrease of the cost that the linear model predicts for a step of the shared
        parameters."""
        return float(2.0 * self.gradient @ shared - shared @ self.information @ shared)

    def owns(self, shared: FloatArray) -> list[FloatArray]:
        """Return the nuisance parameters of each manoeuvre after a step of the shared parameters."""
        return [free - follow @ shared for free, follow in zip(self.free, self.follow, strict=True)]

    def squares_ahead(self, linear: Sequence[Linear]) -> FloatArray:
        """Return the predicted sums of squared residuals after the step, shape (channels,)."""
        owns = self.owns(self.shared)
        each = [b.squares_after(self.shared, own) for b, own in zip(linear, owns, strict=True)]
        return np.asarray(np.sum(each, axis=0))


def own_eliminated(block: Linear, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the normal equations of one manoeuvre without its nuisance parameters (Schur complement).

    Returns
    -------
    Shape (k + 1, k + 1), with the residual as last row and column. The second result is the response of the
    nuisance parameters, shape (m, k + 1).
    """
    m = len(block.prior)
    q = block.products.shape[1]
    normal = (weights**2 @ block.products.reshape(len(weights), q * q)).reshape(q, q)
    AX = normal[:m, m:]
    AX[:, -1] += block.prior * block.departure
    eliminated = solved(factor_of(normal[:m, :m].copy(), block.prior), AX)
    inner: FloatArray = normal[m:, m:] - AX.T @ eliminated
    return inner, eliminated


def solve_blocks(
    problem: EffectProblem, linear: Sequence[Linear], weights: FloatArray, point: SearchPoint
) -> SearchStep:
    """Return one Gauss-Newton step, with nuisance parameters eliminated manoeuvre by manoeuvre."""
    k = linear[0].shared.shape[1]
    precision, departure = problem.prior_of(point)
    H, g = np.diag(precision), precision * departure
    free, follow = [], []
    for block in linear:
        inner, eliminated = own_eliminated(block, weights)
        H += inner[:k, :k]
        g += inner[:k, k]
        free.append(eliminated[:, k])
        follow.append(eliminated[:, :k])
    lower, upper = bounds_of(point)
    return SearchStep(solved_within(H, g, lower - point.shared, upper - point.shared), free, follow, H, g)


def bounds_of(point: SearchPoint) -> tuple[FloatArray, FloatArray]:
    """Return lower and upper bounds of the shared parameters, within the derivatives of a flyable
    aircraft."""
    free = np.full(len(point.derivatives), np.inf)
    lower = np.concatenate([-free, *[np.array([b[0] for b in e.bounds]) for e in point.effects]])
    upper = np.concatenate([_MOST, *[np.array([b[1] for b in e.bounds]) for e in point.effects]])
    return lower, upper
