"""Natural widths, and the probabilities that kept evidence has with them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from advisor.gap.inference.residual import NATURAL, Residual

from .evidence import GRID, KeptFlight, KeptRow

LEAST_SHARE = 1e-3
"""Probability below which the log score of a flight falls no further."""
_LEAST_MISFIT = 0.25
"""Numerical: size of a residual below which the residual counts as zero."""


@dataclass(frozen=True)
class Widths:
    """Numbers of the diagnosis that say what is natural."""

    natural: float
    """Motion that a right simulator leaves unexplained, as a share of a channel's peak."""
    right_std: float
    """Standard deviation of the log of a right model's residual."""
    lacking_mean: float
    """Mean of the log of the residual of a model that lacks a law."""
    lacking_std: float
    effects: float = 1.0
    """Factor on the natural size of each effect."""
    by_data_sheets: bool = False
    """Whether data sheets add to the natural residual of each channel."""

    @classmethod
    def in_use(cls) -> Self:
        """Return the widths of the diagnosis as it stands."""
        right, lacking = (log_normal_of(lambda size, k=k: Residual(size, {}).nats(False)[k]) for k in (0, 1))
        return cls(NATURAL * float(np.exp(right[0])), right[1], lacking[0] - right[0], lacking[1])

    @property
    def vector(self) -> np.ndarray:
        """Shape (5,): logs of the widths, and the mean of the lacking model's log residual."""
        logs = np.log([self.natural, self.right_std, self.lacking_std, self.effects])
        return np.array([*logs, self.lacking_mean])

    def at(self, vector: np.ndarray) -> Self:
        """Return the widths that have a vector."""
        natural, right_std, lacking_std, effects = map(float, np.exp(vector[:4]))
        return replace(
            self, natural=natural, right_std=right_std, lacking_std=lacking_std, effects=effects,
            lacking_mean=float(vector[4]),
        )  # fmt: skip

    def density(self, row: KeptRow) -> float:
        """Return the log density of a row's residual, nats."""
        size = (row.sheet_size if self.by_data_sheets else row.size) * NATURAL / self.natural
        mean, std = (self.lacking_mean, self.lacking_std) if row.lacks else (0.0, self.right_std)
        return float(-0.5 * ((np.log(max(size, _LEAST_MISFIT)) - mean) / std) ** 2 - np.log(std))

    def weight(self, row: KeptRow) -> float:
        """Return the log weight of a row, nats."""
        more = np.interp(np.log(self.effects), np.log(GRID), row.natural) if row.natural else 0.0
        return row.nats + self.density(row) + float(more)


def log_normal_of(density: Callable[[float], float]) -> tuple[float, float]:
    """Return mean and standard deviation of the log of a size from the size's log density.

    The log density of a log-normal size, per unit of the log, is a parabola of the log: three values give it.
    """
    low, middle, high = (density(float(np.exp(x))) for x in (0.0, 1.0, 2.0))
    curvature = 2.0 * middle - low - high
    return float((high - low) / (2.0 * curvature) + 1.0), float(curvature**-0.5)


def probabilities(flight: KeptFlight, widths: Widths) -> dict[str, float]:
    """Return the probability of each name of a flight's alternatives."""
    weights = np.array([widths.weight(row) for row in flight.rows])
    shares = np.exp(weights - np.max(weights))
    shares /= np.sum(shares)
    each: dict[str, float] = {}
    for row, share in zip(flight.rows, shares.tolist(), strict=True):
        each[row.name] = each.get(row.name, 0.0) + share
    return each


def log_score(flight: KeptFlight, widths: Widths) -> float:
    """Return the log of the probability of the truth, nats, at least that of ``LEAST_SHARE``."""
    each = probabilities(flight, widths)
    return float(np.log(max(sum(each.get(name, 0.0) for name in flight.right), LEAST_SHARE)))


def mean_score(flights: Sequence[KeptFlight], widths: Widths) -> float:
    """Return the mean log score of flights, nats a flight."""
    return float(np.mean([log_score(flight, widths) for flight in flights]))
