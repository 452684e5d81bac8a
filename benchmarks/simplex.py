"""The paper's minimisation by the Nelder-Mead simplex, kept for comparison.

The simplex minimises log J instead of J. At J ~ 1e-12 an absolute tolerance on J is meaningless, and the
search stops 1-4 % above the optimum.
"""

import numpy as np
from scipy.optimize import minimize

from advisor.model.outputs import N_PARAMETERS, N_SHARED
from advisor.model.response import Grid, Index, respond
from advisor.oem.gauss_newton import CONVERGED, EXHAUSTED, OVERFLOW, Optimum, weigh
from advisor.process.arrays import FloatArray

FIRST_STEP = 0.05
"""Relative size of the first simplex, as in ``fminsearch``: 5 % of each parameter, 0.00025 where it is
zero."""
ZERO_STEP = 0.00025
MOST_ROUNDS = 12


def descend_by_simplex(
    grid: Grid,
    z: FloatArray,
    channel: Index,
    owner: Index,
    free: Index,
    floor: FloatArray,
    shared: FloatArray,
    local: FloatArray,
) -> Optimum:
    """Minimise Σ n_c·log σ_c² by Nelder-Mead; arguments and result are those of ``gauss_newton.descend``.

    The simplex restarts at its own end until that no longer helps, because it collapses in valleys as narrow
    as those of Z_q and Z_δe.
    """
    common, own = free[free < N_SHARED], free[free >= N_SHARED] - N_SHARED
    y, none = np.empty(len(z)), np.empty((0, N_PARAMETERS))

    def unpack(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        moved_shared, moved_local = shared.copy(), local.copy()
        moved_shared[common] = x[: len(common)]
        moved_local[:, own] = x[len(common) :].reshape(len(local), len(own))
        return moved_shared, moved_local

    def cost(x: FloatArray) -> float:
        if not respond(grid, *unpack(x), y, none):
            return 1e300
        return float(weigh(z, y, channel, floor)[1])

    x = np.concatenate([shared[common], local[:, own].ravel()])
    best = cost(x)
    if best >= 1e300:
        return Optimum(OVERFLOW, shared, local, np.zeros(4), best, 0, y, none)
    iterations = 0
    status = EXHAUSTED
    for _ in range(MOST_ROUNDS):
        simplex = np.vstack([x, x + np.diag(np.where(x != 0.0, FIRST_STEP * x, ZERO_STEP))])
        result = minimize(
            cost,
            x,
            method="Nelder-Mead",
            options={
                "initial_simplex": simplex,
                "xatol": 1e-9,
                "fatol": 1e-8,
                "maxiter": 400 * len(x),
                "maxfev": 800 * len(x),
                "adaptive": True,
            },
        )
        iterations += int(result.nit)
        gain, best, x = best - float(result.fun), float(result.fun), result.x
        if gain < 1e-7:
            status = CONVERGED
            break
    moved_shared, moved_local = unpack(x)
    g = np.empty((len(z), N_PARAMETERS))
    respond(grid, moved_shared, moved_local, y, g)
    noise, total = weigh(z, y, channel, floor)
    return Optimum(status, moved_shared, moved_local, noise, float(total), iterations, y, g)
