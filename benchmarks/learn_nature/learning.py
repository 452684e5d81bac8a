"""Widths by log score, and their score on the generator that was left out."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from .evidence import KeptFlight
from .weighing import Widths, log_score, mean_score

PRIOR_STD = float(np.log(2.0))
"""Prior: standard deviation of each log width about the width in use. A width is known to a factor of two."""


def learnt(flights: Sequence[KeptFlight], begin: Widths) -> Widths:
    """Return the widths with the largest log score of flights and log prior about the first widths.

    Every generator counts alike, whatever its number of flights.
    """
    start = begin.vector
    names = [flight.generator for flight in flights]
    shares = np.array([len(names) / names.count(name) / len(set(names)) for name in names])

    def price(vector: np.ndarray) -> float:
        widths = begin.at(vector)
        scores = np.array([log_score(flight, widths) for flight in flights])
        return float(0.5 * np.sum(((vector - start) / PRIOR_STD) ** 2) - shares @ scores)

    best = minimize(
        price, start, method="Nelder-Mead", options={"xatol": 0.01, "fatol": 0.01, "maxiter": 400}
    )
    return begin.at(best.x)


@dataclass(frozen=True)
class LeftOut:
    """Log scores, nats a flight, on one generator."""

    generator: str
    flights: int
    in_use: float
    by_data_sheets: float
    on_all: float
    """Score of the widths that were set on all generators, this one among them."""
    on_others: float
    """Score of the widths that were set on the other generators."""

    @property
    def lost(self) -> float:
        """Score that the widths lose because the generator was left out, nats a flight."""
        return self.on_all - self.on_others


def left_out_each(
    flights: Sequence[KeptFlight], begin: Widths, on_all: Widths, sheets: Widths
) -> Iterator[LeftOut]:
    """Yield the scores of each generator, left out of the learning once."""
    for name in dict.fromkeys(flight.generator for flight in flights):
        mine = [flight for flight in flights if flight.generator == name]
        others = [flight for flight in flights if flight.generator != name]
        apart = mean_score(mine, learnt(others, begin)) if others else float("nan")
        yield LeftOut(
            name,
            len(mine),
            mean_score(mine, begin),
            mean_score(mine, sheets),
            mean_score(mine, on_all),
            apart,
        )
