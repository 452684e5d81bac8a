"""Compiled estimates of single manoeuvres that share the time grid and the input."""

import numpy as np

from advisor.model.outputs import N_SHARED
from advisor.model.response import Grid, Index
from advisor.oem.arrow import cholesky, normal_equations, solve_lower
from advisor.oem.gauss_newton import CONVERGED, FLAT, descend
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel()
def solve_each(
    grid: Grid,
    z: FloatArray,
    channel: Index,
    owner: Index,
    free: Index,
    floor: FloatArray,
    shared: FloatArray,
    local: FloatArray,
    position: Index,
) -> tuple[FloatArray, FloatArray, FloatArray, Index]:
    """Return parameters (n, 8), Cramér-Rao deviations (n, 8), noise (n, 2) and iterations (n,) of every row.

    Iterations are -1 where the search did not converge.

    Parameters
    ----------
    z
        Shape (n, N): measurements, one manoeuvre per row.
    position
        Shape (8,): index of each reported parameter among shared and local parameters.
    """
    rows = len(z)
    found = np.full((rows, 8), np.nan)
    bounds = np.full((rows, 8), np.nan)
    noise = np.full((rows, 2), np.nan)
    iterations = np.full(rows, -1)
    for i in range(rows):
        optimum = descend(grid, z[i], channel, owner, free, floor, np.zeros(N_SHARED), shared, local, FLAT)
        if optimum.status != CONVERGED:
            continue
        information, _ = normal_equations(
            len(local), z[i] - optimum.fitted, optimum.sensitivities, channel, owner, free, optimum.noise
        )
        if not cholesky(information[0]):
            continue
        inverse = np.eye(len(free))
        solve_lower(information[0], inverse)
        for j in range(8):
            at = np.searchsorted(free, position[j])
            bounds[i, j] = np.sqrt(np.sum(inverse[:, at] ** 2))
            found[i, j] = optimum.shared[position[j]] if j % 4 else optimum.local[0, j // 4]
        noise[i] = optimum.noise[:2]
        iterations[i] = optimum.iterations
    return found, bounds, noise, iterations
