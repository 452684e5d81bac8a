"""Normal equations in arrow shape, and their solutions.

All manoeuvres share the derivatives, and each manoeuvre has nuisance parameters. The nuisance parameters are
eliminated manoeuvre by manoeuvre, so the work grows linearly with the number of manoeuvres. The compiled
functions solve small systems in a search. LAPACK solves larger systems, and systems with bounds.
"""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from advisor.model.response import Index
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

BLOCK = 64
"""Number of rows whose products are summed in one block."""
LEAST_EIGENVALUE = 1e-13
"""Eigenvalue of a unit-diagonal information matrix below which a direction is undetermined."""
_SOUND = 1e-2
"""Least pivot of a unit-diagonal matrix that counts as well conditioned."""


@kernel(fastmath={"reassoc", "contract"})
def _add_products(block: FloatArray, information: FloatArray, gradient: FloatArray) -> None:
    """Add the inner products of the rows of ``block`` (n + 1, BLOCK); sums may be reordered to run in
    parallel."""
    n = len(gradient)
    for j in range(n):
        for k in range(j + 1):
            total = 0.0
            for i in range(BLOCK):
                total += block[j, i] * block[k, i]
            information[j, k] += total
        total = 0.0
        for i in range(BLOCK):
            total += block[j, i] * block[n, i]
        gradient[j] += total


@kernel()
def normal_equations(
    maneuvers: int,
    residual: FloatArray,
    g: FloatArray,
    channel: Index,
    owner: Index,
    free: Index,
    noise: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the information matrix (m, n, n) and the gradient (m, n) of each manoeuvre for the n free
    parameters.

    Only the lower triangles are filled.
    """
    n = len(free)
    information = np.zeros((maneuvers, n, n))
    gradient = np.zeros((maneuvers, n))
    weight = np.zeros(len(noise))
    for c in range(len(noise)):
        weight[c] = 1.0 / noise[c] if noise[c] > 0.0 else 0.0
    block = np.zeros((n + 1, BLOCK))
    filled = 0
    for i in range(len(residual)):
        w = weight[channel[i]]
        for j in range(n):
            block[j, filled] = w * g[i, free[j]]
        block[n, filled] = w * residual[i]
        filled += 1
        if filled == BLOCK or i + 1 == len(residual) or owner[i + 1] != owner[i]:
            block[:, filled:] = 0.0
            _add_products(block, information[owner[i]], gradient[owner[i]])
            filled = 0
    return information, gradient


@kernel()
def cholesky(a: FloatArray) -> bool:
    """Compute the lower factor in place; return False where ``a`` is not numerically positive definite."""
    n = a.shape[0]
    for j in range(n):
        pivot = a[j, j]
        least = 1e-14 * pivot
        for k in range(j):
            pivot -= a[j, k] ** 2
        if not pivot > least:
            return False
        a[j, j] = np.sqrt(pivot)
        for i in range(j + 1, n):
            total = a[i, j]
            for k in range(j):
                total -= a[i, k] * a[j, k]
            a[i, j] = total / a[j, j]
    return True


@kernel()
def solve_lower(a: FloatArray, b: FloatArray) -> None:
    """Solve L·x = b in place for the columns of ``b`` (n, k)."""
    for i in range(a.shape[0]):
        for c in range(b.shape[1]):
            for k in range(i):
                b[i, c] -= a[i, k] * b[k, c]
            b[i, c] /= a[i, i]


@kernel()
def solve_upper(a: FloatArray, b: FloatArray) -> None:
    """Solve Lᵀ·x = b in place for the columns of ``b`` (n, k)."""
    for i in range(a.shape[0] - 1, -1, -1):
        for c in range(b.shape[1]):
            for k in range(i + 1, a.shape[0]):
                b[i, c] -= a[k, i] * b[k, c]
            b[i, c] /= a[i, i]


@kernel()
def _stack(
    information: FloatArray,
    gradient: FloatArray,
    damping: float,
    top: FloatArray,
    right: FloatArray,
    own: FloatArray,
    across: FloatArray,
) -> None:
    """Split the normal equations of one manoeuvre into blocks of shared and nuisance parameters.

    Parameters
    ----------
    information : (k, k), gradient : (k,), shared parameters first.
    top : (w, w), right : (w, 1) of the w shared parameters; the manoeuvre's part is added.
    own : (n, n) receives the damped equations of the n local parameters.
    across : (n, w + 1) receives the rows that couple local to shared parameters, and the local gradient last.
    """
    width, n = len(top), len(own)
    for j in range(width):
        right[j, 0] += gradient[j]
        for k in range(j + 1):
            top[j, k] += information[j, k]
        top[j, j] += damping * information[j, j]
    for j in range(n):
        for k in range(j + 1):
            own[j, k] = information[width + j, width + k]
        own[j, j] *= 1.0 + damping
        for k in range(width):
            across[j, k] = information[width + j, k]
        across[j, width] = gradient[width + j]


@kernel()
def _eliminate(carried: FloatArray, top: FloatArray, right: FloatArray) -> None:
    """Eliminate the nuisance parameters from the shared equations (Schur complement).

    Parameters
    ----------
    carried : (n, w + 1), L⁻¹ times ``across`` of ``_stack``, L being the factor of ``own``.
    top, right : (w, w) and (w, 1), changed in place.
    """
    width = len(top)
    for j in range(width):
        for i in range(len(carried)):
            right[j, 0] -= carried[i, j] * carried[i, width]
            for k in range(j + 1):
                top[j, k] -= carried[i, j] * carried[i, k]


@kernel()
def arrow_step(
    information: FloatArray, gradient: FloatArray, free: Index, damping: float, shared: int, local: int
) -> tuple[bool, FloatArray, FloatArray, float]:
    """Solve the damped normal equations of shared and nuisance parameters.

    Parameters
    ----------
    shared, local : number of parameters that all manoeuvres share, and that each has for itself.

    Returns
    -------
    False when singular; the step of the shared (s,) and of the local parameters (m, l); and
    the promised decrease gradientᵀ·step of the weighted sum of squares.
    """
    maneuvers = len(information)
    width = int(np.sum(free < shared))
    n = len(free) - width
    shared_step, local_step = np.zeros(shared), np.zeros((maneuvers, local))
    top = np.zeros((width, width))
    right = np.zeros((width, 1))
    factors = np.zeros((maneuvers, n, n))
    carried = np.zeros((maneuvers, n, width + 1))
    for m in range(maneuvers):
        _stack(information[m], gradient[m], damping, top, right, factors[m], carried[m])
        if not cholesky(factors[m]):
            return False, shared_step, local_step, 0.0
        solve_lower(factors[m], carried[m])
        _eliminate(carried[m], top, right)
    if not cholesky(top):
        return False, shared_step, local_step, 0.0
    solve_lower(top, right)
    promise = 0.0
    for j in range(width):
        promise += right[j, 0] ** 2
    solve_upper(top, right)
    for j in range(width):
        shared_step[free[j]] = right[j, 0]
    for m in range(maneuvers):
        rest = np.empty((n, 1))
        for i in range(n):
            promise += carried[m, i, width] ** 2
            rest[i, 0] = carried[m, i, width]
            for j in range(width):
                rest[i, 0] -= carried[m, i, j] * right[j, 0]
        solve_upper(factors[m], rest)
        for i in range(n):
            local_step[m, free[width + i] - shared] = rest[i, 0]
    return True, shared_step, local_step, promise


def factored(normal: FloatArray) -> FloatArray:
    """Return the lower Cholesky factor of a symmetric positive definite matrix, shape (m, m).

    Raises
    ------
    np.linalg.LinAlgError
        The matrix is not positive definite, or contains a NaN or an infinity.
    """
    factor, info = dpotrf(normal, lower=1, clean=0)
    if info != 0 or not np.isfinite(factor[-1, -1]):
        raise np.linalg.LinAlgError("the data do not determine the manoeuvre's trim and initial state")
    return np.asarray(factor)


def solved(factor: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solution x of the factored system for a right-hand side, shape (m,) or (m, k)."""
    return np.asarray(dpotrs(factor, right, lower=1)[0])


def solved_within(
    H: FloatArray, g: FloatArray, least: FloatArray, most: FloatArray, indifferent: float = 1e-12
) -> FloatArray:
    """Return the x that minimises ½ xᵀHx − gᵀx with ``least`` ≤ x ≤ ``most``, all of shape (k,).

    A component outside its range is fixed at the end of the range, and the others are solved again. Clipping
    the solution instead would lead away from the optimum where parameters are correlated. H is scaled to a
    unit diagonal. Directions of relative singular values below ``indifferent`` are not moved.
    """
    scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
    normal, right = H / np.outer(scale, scale), g / scale
    x = _solution(normal, right, indifferent) / scale
    free = np.ones(len(g), dtype=bool)
    while np.any(outside := free & ((x < least) | (x > most))):
        x[outside] = np.clip(x, least, most)[outside]
        free &= ~outside
        if not np.any(free):
            break
        with_them = right[free] - normal[np.ix_(free, ~free)] @ (x * scale)[~free]
        x[free] = _solution(normal[np.ix_(free, free)], with_them, indifferent) / scale[free]
    return x


def _solution(normal: FloatArray, right: FloatArray, indifferent: float) -> FloatArray:
    """Return the solution for a unit-diagonal matrix, by singular values only if some may be tiny."""
    factor, info = dpotrf(normal, lower=1, clean=0)
    if info == 0 and np.min(np.diag(factor)) > _SOUND:
        return solved(factor, right)
    return np.asarray(np.linalg.lstsq(normal, right, rcond=indifferent)[0])


def inverse_of(information: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the inverse of a symmetric matrix (n, n), and the undetermined share (n,) of each unknown, 0 to
    1.

    The matrix is scaled to a unit diagonal, so that units do not matter. Directions in which the matrix is
    singular to working precision are left out.
    """
    diagonal = np.diag(information)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    dead = values <= LEAST_EIGENVALUE
    kept = np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, values))
    result: FloatArray = (vectors * kept) @ vectors.T * np.outer(scale, scale)
    return result, np.sum(vectors[:, dead] ** 2, axis=1)


def unabsorbed(
    columns: FloatArray, own: FloatArray, weight: FloatArray, indifferent: float | None = None
) -> FloatArray:
    """Return the part of ``columns`` (n, k) that a manoeuvre's nuisance columns ``own`` (n, l) cannot absorb.

    ``weight`` (n,) is the inverse noise of the rows. Directions of ``own`` with relative singular values
    below ``indifferent`` absorb nothing; None means rounding.
    """
    left, sizes, _ = np.linalg.svd(own * weight[:, None], full_matrices=False)
    least = indifferent or len(own) * np.finfo(float).eps
    left = left[:, sizes > least * np.max(sizes, initial=0.0)]
    return np.asarray(columns - left @ (left.T @ (columns * weight[:, None])) / weight[:, None])
