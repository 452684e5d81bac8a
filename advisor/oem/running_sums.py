"""Compiled sums over the samples of one output (see ``weighted_sums`` and ``colour``)."""

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel()
def add_samples(
    gram: FloatArray,
    coloured: FloatArray,
    kept: FloatArray,
    derivatives: FloatArray,
    residual: FloatArray,
    memory: float,
    white: float,
) -> None:
    """Add further samples to ``gram``, ``coloured`` and ``kept`` in place; shapes are those of ``Sums``."""
    n = len(kept)
    for i in range(len(residual)):
        for j in range(n):
            value = derivatives[i, j]
            for k in range(n):
                other = derivatives[i, k]
                gram[j, k] += value * other
                coloured[j, k] += (1.0 + white) * value * other + value * kept[k] + kept[j] * other
            gram[j, n] += value * residual[i]
            gram[n, j] += value * residual[i]
        gram[n, n] += residual[i] ** 2
        for j in range(n):
            kept[j] = memory * (kept[j] + derivatives[i, j])


@kernel()
def accumulated(samples: FloatArray, memory: float) -> FloatArray:
    """Return y_k = φ·y_(k-1) + x_k over ``samples`` (n, k), with y = 0 before the first sample."""
    total = samples.copy()
    for i in range(1, len(total)):
        for j in range(total.shape[1]):
            total[i, j] += memory * total[i - 1, j]
    return total
