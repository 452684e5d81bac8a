"""Weights for every measurement from its actual noise: generalised least squares.

Let Γ = L·Lᵀ be the autocovariance of the noise. Residuals and sensitivities times L⁻¹ belong to white noise
of unit variance. For white noise the weights are those of output error, 1/σ².
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from advisor.model.outputs import N_LOCAL, N_SHARED, OUTPUTS
from advisor.oem.arrow import arrow_step, normal_equations
from advisor.oem.colour import Colour
from advisor.oem.covariance import Influence, influence
from advisor.oem.extra import Extra
from advisor.oem.rows import Laid
from advisor.oem.whitening import Whitening
from advisor.process.arrays import FloatArray

UNIT = np.ones(len(OUTPUTS))


@dataclass(frozen=True, slots=True)
class Weighing:
    """Factor L⁻¹ for all measurements of a problem."""

    assembly: Laid
    by_maneuver: tuple[Mapping[str, Whitening], ...]
    """Whitening filter of each output, by the output's name, in one mapping per manoeuvre."""

    @classmethod
    def by(cls, colours: Mapping[str, Colour], assembly: Laid) -> "Weighing":
        """Return the weighing for a noise model, valid for any problem with these measurements."""

        def whitening(output: str, samples: int) -> Whitening:
            colour = colours[output]
            # An output that never moves has no residual and no influence; it keeps its unit.
            return Whitening.of(samples, colour.memory, colour.white_share, colour.variance or 1.0)

        return cls(
            assembly,
            tuple(
                {output: whitening(output, rows.stop - rows.start) for output, rows in named.items()}
                for named in assembly.rows
            ),
        )

    @property
    def volume(self) -> float:
        """Logarithm of the determinant of Γ."""
        each = (part for named in self.by_maneuver for part in named.values())
        return -2.0 * sum(float(np.sum(np.log(part.scale))) for part in each)

    def forward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻¹·rows, shape (N, k)."""
        return self._each(Whitening.forward, rows)

    def backward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻ᵀ·rows, shape (N, k)."""
        return self._each(Whitening.backward, rows)

    def influence(self, g: FloatArray, extra: Extra | None) -> Influence | None:
        """Return the influence of every measurement on the efficient estimate; None on numerical overflow."""
        seen = None if extra is None else extra.whitened(self.forward(extra.columns))
        weighed = influence(self.assembly, self.forward(g), UNIT, seen)
        return None if weighed is None else replace(weighed, rows=self.backward(weighed.rows))

    def misfit(self, residual: FloatArray, g: FloatArray) -> float:
        """Return the weighted sum of squares, minus the decrease by one last step of all parameters.

        The difference between two models of one record is twice the log likelihood ratio.
        """
        white = self.forward(residual[:, None])[:, 0]
        a = self.assembly
        information, gradient = normal_equations(
            a.maneuvers, white, self.forward(g), a.channel, a.owner, a.free, UNIT
        )
        *_, promise = arrow_step(information, gradient, a.free, 0.0, N_SHARED, N_LOCAL)
        return float(white @ white) - promise

    def _each(self, apply: Callable[[Whitening, FloatArray], FloatArray], rows: FloatArray) -> FloatArray:
        result = np.empty(rows.shape)
        for named, parts in zip(self.assembly.rows, self.by_maneuver, strict=True):
            for output, part in parts.items():
                result[named[output]] = apply(part, rows[named[output]])
        return result
