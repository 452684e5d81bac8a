"""Compiled first-order recursion over the samples of one output (see ``colour``)."""

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel()
def accumulated(samples: FloatArray, memory: float) -> FloatArray:
    """Return y_k = φ·y_(k-1) + x_k over ``samples`` (n, k), with y = 0 before the first sample."""
    total = samples.copy()
    for i in range(1, len(total)):
        for j in range(total.shape[1]):
            total[i, j] += memory * total[i - 1, j]
    return total
