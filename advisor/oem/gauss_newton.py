"""Minimisation of J = det R, Eq. (7), by Gauss-Newton with R re-estimated at every step.

R = diag(σ_c²) at its own maximum-likelihood value makes minimising Σ n_c·log σ_c² equal to minimising det R.
The gradient is that of the weighted sum of squares at the present R, hence Gauss-Newton with weights 1/σ_c².
The source is Maine & Iliff, *Formulation and implementation of a practical algorithm for parameter estimation
with process and measurement noise*, 1981. Levenberg's damping enters only when a step is rejected, and begins
far below the usual sizes. The record of a diverging aircraft has directions 1e-9 as well determined as
others, and a larger damping would stop the search.

The normal equations have the shape of an arrow: the derivatives are shared by all manoeuvres, and each
manoeuvre has its own nuisance parameters. These are eliminated manoeuvre by manoeuvre, so the work grows
linearly with their number.
"""

from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.axis_response import AxisGrid
from advisor.model.response import Grid, Index, respond
from advisor.process.compiled import kernel

FLAT = 1e-11
"""Promised change of log J below which a step ends the search; the remaining change is far smaller."""
BLOCK = 64
"""Number of rows whose products are summed at once."""
MOST_ITERATIONS = 120
FIRST_DAMPING = 1e-8
"""First damping relative to the diagonal. So small a damping does not hide that a step still promises a
decrease."""
LEAST_DAMPING = 1e-12
DAMPING_FACTOR = 10.0
LEAST_NOISE = 1e-10
"""Least σ relative to the spread of the channel, for data without noise."""

WITHOUT_NOISE = 1e4
"""Factor on that floor below which residuals are round-off of data without noise."""

CONVERGED, EXHAUSTED, OVERFLOW, SINGULAR = 0, 1, 2, 3


class Optimum(NamedTuple):
    """The end of a search."""

    status: int
    """``CONVERGED``, ``EXHAUSTED`` (too many iterations), ``OVERFLOW`` or ``SINGULAR``."""
    shared: FloatArray
    """(s,) parameters that all manoeuvres share."""
    local: FloatArray
    """(m, l) parameters that each manoeuvre has for itself."""
    noise: FloatArray
    """(outputs,) σ of each output; 0 where an output is not measured."""
    log_likelihood_cost: float
    """Σ n_c·log σ_c²."""
    iterations: int
    fitted: FloatArray
    """(N,) outputs of the model at the optimum."""
    sensitivities: FloatArray
    """(N, s + l) derivatives of the outputs by the parameters of the row's manoeuvre."""


@kernel()
def weigh(z: FloatArray, y: FloatArray, channel: Index, floor: FloatArray) -> tuple[FloatArray, float]:
    """Return σ of each output from its residuals, Eq. (8), and the cost Σ n_c·log σ_c²."""
    outputs = len(floor)
    power = np.zeros(outputs)
    count = np.zeros(outputs)
    for i in range(len(z)):
        power[channel[i]] += (z[i] - y[i]) ** 2
        count[channel[i]] += 1.0
    noise = np.zeros(outputs)
    cost = 0.0
    for c in range(outputs):
        if count[c] > 0.0:
            noise[c] = max(np.sqrt(power[c] / count[c]), floor[c])
            cost += 2.0 * count[c] * np.log(noise[c])
    return noise, cost


@kernel(fastmath={"reassoc", "contract"})
def _add_products(block: FloatArray, information: FloatArray, gradient: FloatArray) -> None:
    """Add the products of the rows of ``block`` (n + 1, BLOCK); sums may be reordered to run in parallel."""
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
    grid: Grid | AxisGrid,
    z: FloatArray,
    y: FloatArray,
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
    m = len(grid.first) - 1
    n = len(free)
    information = np.zeros((m, n, n))
    gradient = np.zeros((m, n))
    weight = np.zeros(len(noise))
    for c in range(len(noise)):
        weight[c] = 1.0 / noise[c] if noise[c] > 0.0 else 0.0
    block = np.zeros((n + 1, BLOCK))
    filled = 0
    for i in range(len(z)):
        w = weight[channel[i]]
        for j in range(n):
            block[j, filled] = w * g[i, free[j]]
        block[n, filled] = w * (z[i] - y[i])
        filled += 1
        if filled == BLOCK or i + 1 == len(z) or owner[i + 1] != owner[i]:
            block[:, filled:] = 0.0
            _add_products(block, information[owner[i]], gradient[owner[i]])
            filled = 0
    return information, gradient


@kernel()
def cholesky(a: FloatArray) -> bool:
    """Compute the lower factor in place; return False where ``a`` is not positive definite to working
    precision."""
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
    """Subtract from the shared equations the part that the nuisance parameters absorb (Schur complement).

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
    """Solve the damped normal equations.

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


@kernel()
def descend(
    grid: Grid,
    z: FloatArray,
    channel: Index,
    owner: Index,
    free: Index,
    floor: FloatArray,
    prior: FloatArray,
    shared: FloatArray,
    local: FloatArray,
    flat: float = FLAT,
) -> Optimum:
    """Minimise Σ n_c·log σ_c² from a start. Shapes as in ``Laid``; ``floor`` (outputs,) of σ.

    ``prior`` (s,) holds inverse prior variances of the shared parameters about zero, which the cost includes.
    """
    shared, local = shared.copy(), local.copy()
    parameters = len(shared) + local.shape[1]
    y, g = np.empty(len(z)), np.empty((len(z), parameters))
    y_trial, g_trial = np.empty(len(z)), np.empty((len(z), parameters))
    if not respond(grid, shared, local, y, g):
        return Optimum(OVERFLOW, shared, local, np.zeros(len(floor)), np.inf, 0, y, g)
    noise, cost = weigh(z, y, channel, floor)
    cost += np.sum(prior * shared**2)
    damping = 0.0
    status = EXHAUSTED
    iteration = 0
    while iteration < MOST_ITERATIONS:
        iteration += 1
        information, gradient = normal_equations(grid, z, y, g, channel, owner, free, noise)
        for j in range(len(free)):
            if free[j] < len(shared):
                information[0, j, j] += prior[free[j]]
                gradient[0, j] -= prior[free[j]] * shared[free[j]]
        accepted = False
        for _ in range(16):
            fine, shared_step, local_step, promise = arrow_step(
                information, gradient, free, damping, len(shared), local.shape[1]
            )
            if fine:
                trial, trial_local = shared + shared_step, local + local_step
                if respond(grid, trial, trial_local, y_trial, g_trial):
                    trial_noise, trial_cost = weigh(z, y_trial, channel, floor)
                    trial_cost += np.sum(prior * trial**2)
                    if trial_cost <= cost:
                        accepted = True
                        break
                if promise < flat * len(z):
                    return Optimum(CONVERGED, shared, local, noise, cost, iteration, y, g)
            damping = max(FIRST_DAMPING, DAMPING_FACTOR * damping)
        if not accepted:
            # Not even a tiny step lowers the cost: only round-off remains.
            status = CONVERGED if fine else SINGULAR
            break
        shared, local, noise, cost = trial, trial_local, trial_noise, trial_cost
        y, y_trial = y_trial, y
        g, g_trial = g_trial, g
        if promise < flat * len(z) and damping <= FIRST_DAMPING:
            status = CONVERGED
            break
        damping = damping / DAMPING_FACTOR if damping > LEAST_DAMPING else 0.0
    if status == EXHAUSTED and np.all(noise <= WITHOUT_NOISE * floor):
        status = CONVERGED
    return Optimum(status, shared, local, noise, cost, iteration, y, g)
