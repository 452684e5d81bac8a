"""Parameters that a problem has in addition to the derivatives, and their priors.

Examples are a servo's lag, the delay of the command, and the time of a step between two stamps. A prior acts
like one more measurement of its parameter. The prior adds to the information and pulls the estimate, and its
error is part of the estimate's covariance.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Prior:
    """Gaussian prior of one parameter, in the parameter's unit."""

    mean: float
    std: float
    share: float = 1.0
    """Factor on ``std`` when a white-noise fit weights the prior. A white-noise fit overrates coloured data,
    so the prior must be narrowed by an equal factor."""


class Parameter(Protocol):
    """A parameter of a problem that is estimated with the derivatives."""

    @property
    def prior(self) -> Prior | None:
        """Prior of the parameter; None without one."""

    def read(self, problem: Any, /) -> float:
        """Return the parameter's value in a problem."""

    def moved(self, problem: Any, change: float, /) -> Any:
        """Return the problem with the parameter changed, within its range and its largest step."""


def moved_by(step: FloatArray, problem: Any, parameters: Sequence[Parameter]) -> Any:
    """Return the problem with its parameters changed by ``step`` (k,), each in its unit."""
    for x, change in zip(parameters, step.tolist(), strict=True):
        problem = x.moved(problem, change)
    return problem


def penalty(problem: object, parameters: Iterable[Parameter]) -> float:
    """Return -2 log of the priors' density, up to a constant, with the weights of a white-noise fit."""
    stated = [(x.read(problem), x.prior) for x in parameters if x.prior is not None]
    return sum(((value - prior.mean) / (prior.std * prior.share)) ** 2 for value, prior in stated)


@dataclass(frozen=True, slots=True)
class Extra:
    """Additional parameters at one set of values."""

    columns: FloatArray
    """Shape (N, k): derivatives of the outputs by the additional parameters."""
    weight: FloatArray
    """Shape (k,): inverse standard deviation of each prior; 0 without a prior."""
    pull: FloatArray
    """Shape (k,): (prior mean − value) / prior standard deviation; 0 without a prior."""
    share: FloatArray
    """Shape (k,): factor on each prior's standard deviation in the fit (``Prior.share``)."""

    @classmethod
    def at(cls, columns: FloatArray, values: FloatArray, priors: Sequence[Prior | None]) -> "Extra":
        """Return additional parameters at ``values`` (k,) with their priors."""
        given = [prior or Prior(0.0, np.inf) for prior in priors]
        mean, std, share = np.array([(p.mean, p.std, p.share) for p in given]).reshape(-1, 3).T
        return cls(columns, 1.0 / std, (mean - values) / std, share)

    @classmethod
    def of(cls, columns: FloatArray, problem: object, parameters: Sequence[Parameter]) -> "Extra":
        """Return additional parameters at their values in a problem."""
        return cls.at(columns, np.array([x.read(problem) for x in parameters]), [x.prior for x in parameters])

    @classmethod
    def none(cls, rows: int) -> "Extra":
        """Return an empty set of parameters for a problem with ``rows`` measurements."""
        return cls(np.empty((rows, 0)), np.empty(0), np.empty(0), np.empty(0))

    def __len__(self) -> int:
        return len(self.weight)

    @property
    def penalty(self) -> float:
        """-2 log of the priors' density, up to a constant."""
        return float(self.pull @ self.pull)

    def whitened(self, columns: FloatArray) -> "Extra":
        """Return the parameters with whitened derivatives, for which priors have their true width."""
        return Extra(columns, self.weight, self.pull, np.ones(len(self)))

    def joined(self, other: "Extra") -> "Extra":
        """Return the parameters of both sets, with those of ``other`` last."""
        return Extra(
            np.column_stack([self.columns, other.columns]),
            np.concatenate([self.weight, other.weight]),
            np.concatenate([self.pull, other.pull]),
            np.concatenate([self.share, other.share]),
        )
