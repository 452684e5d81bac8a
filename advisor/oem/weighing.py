"""Weighing every measurement by the noise as it is: generalised least squares.

With Γ = L·Lᵀ the noise's autocovariance, residuals and sensitivities times L⁻¹ are those of a problem with
white noise of unit variance, and every formula for white noise holds for them. Where no output's noise is
coloured, this is output error's own weighing, 1/σ².
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.covariance import Coloured, influence
from advisor.oem.gauss_newton import arrow_step, normal_equations
from advisor.oem.problem import Assembly
from advisor.oem.whitening import Whitening

UNIT = np.ones(len(OUTPUTS))


@dataclass(frozen=True, slots=True)
class Weighing:
    """L⁻¹ of all measurements of a problem."""

    assembly: Assembly
    by_maneuver: tuple[Mapping[str, Whitening], ...]
    """For each manoeuvre, output name to its part."""

    @classmethod
    def by(cls, noise: Coloured, assembly: Assembly) -> "Weighing":
        """By noise of these colours; any problem about the same measurements may be weighed by it."""

        def whitening(output: str, samples: int) -> Whitening:
            colour = noise.colours[output]
            # An output that never moves leaves nothing over and has no say; it keeps its unit.
            return Whitening.of(samples, colour.memory, colour.white_share, colour.variance or 1.0)

        return cls(
            assembly,
            tuple(
                {output: whitening(output, rows.stop - rows.start) for output, rows in named.items()}
                for named in assembly.rows
            ),
        )

    def forward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻¹·rows, (N, k)."""
        return self._each(Whitening.forward, rows)

    def backward(self, rows: FloatArray) -> FloatArray:
        """Return l⁻ᵀ·rows, (N, k)."""
        return self._each(Whitening.backward, rows)

    def influence(self, g: FloatArray, extra: FloatArray | None) -> FloatArray | None:
        """Return (N, 8 + k) influence of every measurement on the efficient estimate; None when it
        overflows."""
        weighed = influence(
            self.assembly, self.forward(g), UNIT, None if extra is None else self.forward(extra)
        )
        return None if weighed is None else self.backward(weighed.rows)

    def misfit(self, residual: FloatArray, g: FloatArray) -> float:
        """Return weighed sum of squares, less what a last step of all parameters would still take off.

        The difference between two readings of one record is twice their log-likelihood ratio.
        """
        white = self.forward(residual[:, None])[:, 0]
        a = self.assembly
        information, gradient = normal_equations(
            a.grid, white, np.zeros(len(white)), self.forward(g), a.channel, a.owner, a.free, UNIT
        )
        *_, promise = arrow_step(information, gradient, a.free, 0.0)
        return float(white @ white) - promise

    def _each(self, apply: Callable[[Whitening, FloatArray], FloatArray], rows: FloatArray) -> FloatArray:
        result = np.empty(rows.shape)
        for named, parts in zip(self.assembly.rows, self.by_maneuver, strict=True):
            for output, part in parts.items():
                result[named[output]] = apply(part, rows[named[output]])
        return result
