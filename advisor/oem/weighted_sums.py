"""Compiled sums over samples that determine a linear fit about one point.

G has the derivatives of an output, r is its residual. [G r]ᵀ[G r] gives the step, the noise after it and the
Cramér-Rao bound for any weight of the output. GᵀΓG, with the autocovariance Γ of coloured noise, gives the
errors corrected for colour. For first-order noise a running sum replaces the earlier samples.
"""

from dataclasses import dataclass

import numpy as np

from advisor.oem.colour import Colour
from advisor.oem.running_sums import add_samples
from advisor.process.arrays import FloatArray


@dataclass(slots=True)
class Sums:
    """Sums over the samples of one output for a linear fit."""

    colour: Colour
    gram: FloatArray
    """Shape (n + 1, n + 1): inner products of the derivatives by n parameters, and of the residual."""
    coloured: FloatArray
    """Shape (n, n): GᵀΓG over the variance of the coloured part."""
    kept: FloatArray
    """Shape (n,): Σ memoryᵏ·g over the samples so far, with k = 1 for the newest sample."""
    samples: int = 0

    @classmethod
    def none(cls, parameters: int, colour: Colour) -> "Sums":
        """Return the sums over no samples, all zero."""
        n = parameters
        return cls(colour, np.zeros((n + 1, n + 1)), np.zeros((n, n)), np.zeros(n))

    def add(self, derivatives: FloatArray, residual: FloatArray) -> None:
        """Add samples in order of time, with derivatives (k, n) and residuals (k,)."""
        memory, white = self.colour.memory, self.colour.white_share
        add_samples(self.gram, self.coloured, self.kept, derivatives, residual, memory, white)
        self.samples += len(residual)

    def power(self, step: FloatArray) -> float:
        """Return the mean square of the residual after a step of the parameters (n,)."""
        moved = np.append(-step, 1.0)
        return max(float(moved @ self.gram @ moved), 0.0) / self.samples
