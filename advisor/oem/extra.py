"""Parameters that a problem has in addition to the derivatives, with their priors.

Examples are a servo's lag, the delay of the command, and the time of a step between two stamps. A prior is
one more measurement of its parameter. The prior adds to the information and pulls the estimate, and its error
is part of the estimate's covariance.
"""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray


@dataclass(frozen=True, slots=True)
class Prior:
    """Gaussian knowledge of one parameter before the flight, in the parameter's unit."""

    mean: float
    std: float


@dataclass(frozen=True, slots=True)
class Extra:
    """Additional parameters at one setting."""

    columns: FloatArray
    """(N, k) derivatives of the outputs by the parameters."""
    weight: FloatArray
    """(k,) inverse standard deviation of each prior; 0 without a prior."""
    pull: FloatArray
    """(k,) prior's mean minus the value, over the prior's standard deviation; 0 without a prior."""

    @classmethod
    def at(cls, columns: FloatArray, values: FloatArray, mean: FloatArray, std: FloatArray) -> "Extra":
        """Return parameters at ``values`` with priors of ``mean`` and ``std``, shape (k,) each; infinite
        without a prior."""
        return cls(columns, 1.0 / std, (mean - values) / std)

    @classmethod
    def none(cls, rows: int) -> "Extra":
        """Return no parameter, for a problem with this number of measurements."""
        return cls(np.empty((rows, 0)), np.empty(0), np.empty(0))

    def __len__(self) -> int:
        return len(self.weight)

    @property
    def penalty(self) -> float:
        """-2 log of the priors' density, up to a constant."""
        return float(self.pull @ self.pull)

    def with_columns(self, columns: FloatArray) -> "Extra":
        """Return the parameters with other derivatives, such as whitened ones."""
        return Extra(columns, self.weight, self.pull)

    def joined(self, other: "Extra") -> "Extra":
        """Return these parameters, and then the other ones."""
        return Extra(
            np.column_stack([self.columns, other.columns]),
            np.concatenate([self.weight, other.weight]),
            np.concatenate([self.pull, other.pull]),
        )
