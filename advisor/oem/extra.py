"""Parameters that a problem has in addition to the derivatives, with their priors.

Examples are a servo's lag, the delay of the command, and the time of a step between two stamps. A prior is
one more measurement of its parameter. The prior adds to the information and pulls the estimate, and its error
is part of the estimate's covariance.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from advisor.flight.signals.messages import FloatArray


@dataclass(frozen=True, slots=True)
class Prior:
    """Gaussian knowledge of one parameter before the flight, in the parameter's unit."""

    mean: float
    std: float
    share: float = 1.0
    """Standard deviation with which white noise weighs the prior, over ``std``. White noise makes coloured
    data look more certain than they are, and the prior must look as much more certain."""


class Parameter(Protocol):
    """A number of a problem that is estimated with the derivatives."""

    @property
    def prior(self) -> Prior | None:
        """Knowledge before the flight."""

    def read(self, problem: Any, /) -> float:
        """Return the value in a problem."""

    def moved(self, problem: Any, change: float, /) -> Any:
        """Return the problem with the value changed, within its range and by no more than one step may."""


def moved_by(step: FloatArray, problem: Any, parameters: Sequence[Parameter]) -> Any:
    """Return the problem with its parameters moved by ``step`` (k,), each in its unit."""
    for x, change in zip(parameters, step.tolist(), strict=True):
        problem = x.moved(problem, change)
    return problem


def penalty(problem: object, parameters: Iterable[Parameter]) -> float:
    """Return -2 log of the priors' density up to a constant, as white noise weighs the priors."""
    known = [(x.read(problem), x.prior) for x in parameters if x.prior is not None]
    return sum(((value - prior.mean) / (prior.std * prior.share)) ** 2 for value, prior in known)


@dataclass(frozen=True, slots=True)
class Extra:
    """Additional parameters at one setting."""

    columns: FloatArray
    """(N, k) derivatives of the outputs by the parameters."""
    weight: FloatArray
    """(k,) inverse standard deviation of each prior; 0 without a prior."""
    pull: FloatArray
    """(k,) prior's mean minus the value, over the prior's standard deviation; 0 without a prior."""
    share: FloatArray
    """(k,) share of each standard deviation with which the fit weighs the prior (``Prior.share``)."""

    @classmethod
    def at(cls, columns: FloatArray, values: FloatArray, priors: Sequence[Prior | None]) -> "Extra":
        """Return parameters at ``values`` (k,) with their priors."""
        known = [prior or Prior(0.0, np.inf) for prior in priors]
        mean, std, share = np.array([(p.mean, p.std, p.share) for p in known]).reshape(-1, 3).T
        return cls(columns, 1.0 / std, (mean - values) / std, share)

    @classmethod
    def of(cls, columns: FloatArray, problem: object, parameters: Sequence[Parameter]) -> "Extra":
        """Return parameters at their values in a problem."""
        return cls.at(columns, np.array([x.read(problem) for x in parameters]), [x.prior for x in parameters])

    @classmethod
    def none(cls, rows: int) -> "Extra":
        """Return no parameter, for a problem with this number of measurements."""
        return cls(np.empty((rows, 0)), np.empty(0), np.empty(0), np.empty(0))

    def __len__(self) -> int:
        return len(self.weight)

    @property
    def penalty(self) -> float:
        """-2 log of the priors' density, up to a constant."""
        return float(self.pull @ self.pull)

    def whitened(self, columns: FloatArray) -> "Extra":
        """Return the parameters with whitened derivatives, to which a prior is as certain as it is."""
        return Extra(columns, self.weight, self.pull, np.ones(len(self)))

    def joined(self, other: "Extra") -> "Extra":
        """Return the parameters of both sets, the given set last."""
        return Extra(
            np.column_stack([self.columns, other.columns]),
            np.concatenate([self.weight, other.weight]),
            np.concatenate([self.pull, other.pull]),
            np.concatenate([self.share, other.share]),
        )
