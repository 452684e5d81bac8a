"""Compiled restricted likelihood of residuals with coloured noise (see ``colour``)."""

import numpy as np

from advisor.oem.whitening import schedule, whiten
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel(fastmath={"reassoc", "contract"})
def restricted(block: FloatArray, memory: float, share: float) -> tuple[float, float]:
    """Return the residual power after whitening and regression, and log det Γ + log det XᵀΓ⁻¹X.

    ``block`` (n, p + 1) holds regressors and residual; Γ belongs to an x of unit variance.
    """
    n, width = block.shape
    scale, gain, determinants = schedule(n, memory, share)
    white = whiten(block, memory, scale, gain)
    gram = np.empty((width, width))
    for i in range(width):
        for j in range(i + 1):
            dot = 0.0
            for k in range(n):
                dot += white[i, k] * white[j, k]
            gram[i, j] = dot
    for j in range(width):
        for k in range(j):
            gram[j, j] -= gram[j, k] ** 2
        if j == width - 1:
            return gram[j, j], determinants
        gram[j, j] = np.sqrt(max(gram[j, j], 1e-300))
        determinants += 2.0 * np.log(gram[j, j])
        for i in range(j + 1, width):
            for k in range(j):
                gram[i, j] -= gram[i, k] * gram[j, k]
            gram[i, j] /= gram[j, j]
    return 0.0, determinants
