"""All that a fit linear about one place needs of the samples: sums that grow with each, compiled.

With G the derivatives of an output and r its residual, [G r]ᵀ[G r] gives the step, the noise after it and
the Cramér-Rao bound for any weight of the output. GᵀΓG, with Γ the autocovariance of noise that remembers,
gives the errors corrected for colour. A first-order memory needs of the earlier samples a running sum only.
"""

from dataclasses import dataclass

import numpy as np

from advisor.compiled import kernel
from advisor.flight.messages import FloatArray
from advisor.oem.colour import Colour


@dataclass(slots=True)
class Sums:
    """Sums over the samples of one output."""

    colour: Colour
    gram: FloatArray
    """(n + 1, n + 1) of the derivatives by the n parameters and the residual."""
    coloured: FloatArray
    """(n, n) GᵀΓG over the variance of the remembering part."""
    kept: FloatArray
    """(n,) Σ memoryᵏ·g over the samples so far, the newest at k = 1."""
    samples: int = 0

    @classmethod
    def none(cls, parameters: int, colour: Colour) -> "Sums":
        """Return sums over no samples."""
        n = parameters
        return cls(colour, np.zeros((n + 1, n + 1)), np.zeros((n, n)), np.zeros(n))

    def add(self, derivatives: FloatArray, residual: FloatArray) -> None:
        """Take further samples in order of time: (k, n) derivatives, (k,) residuals."""
        memory, white = self.colour.memory, self.colour.white_share
        _add(self.gram, self.coloured, self.kept, derivatives, residual, memory, white)
        self.samples += len(residual)

    def power(self, step: FloatArray) -> float:
        """Return the mean square of the residual after a step of the parameters (n,)."""
        moved = np.append(-step, 1.0)
        return max(float(moved @ self.gram @ moved), 0.0) / self.samples


@kernel()
def _add(
    gram: FloatArray,
    coloured: FloatArray,
    kept: FloatArray,
    derivatives: FloatArray,
    residual: FloatArray,
    memory: float,
    white: float,
) -> None:
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
