"""Scores of the judge, each generator judged by a fit on the others."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.judge.prior import FieldPrior
from benchmarks.judge.fit import fitted, flown_prior
from benchmarks.judge.flights import JudgedFlight

SURE = 0.9
_BINS = 10


@dataclass(frozen=True)
class Told:
    """One flight with a first answer and its stated probability."""

    flight: JudgedFlight
    is_right: bool
    is_quiet: bool
    """Whether the answer is none or parameters."""
    probability: float
    by_rules: float
    """Probability of the rules' answer by the judge."""


def left_out(flights: Sequence[JudgedFlight], prior: FieldPrior | None = None) -> list[Told]:
    """Return the answers of the judge on each generator, from a fit without that generator.

    ``prior`` is the field prior of the answers; None: the shares of the generator itself.
    """
    told = []
    for generator in sorted({flight.generator for flight in flights}):
        theirs = [f for f in flights if f.generator == generator]
        logit = fitted([f for f in flights if f.generator != generator])
        told += [answer(logit, flight, prior or flown_prior(theirs)) for flight in theirs]
    return told


def answer(logit, flight: JudgedFlight, prior: FieldPrior) -> Told:  # type: ignore[no-untyped-def]
    """Return the first answer of a judge on a flight."""
    p = logit.probabilities(flight.rows, prior)
    best = int(np.argmax(p))
    quiet = flight.rows[best].alternative.kind in ("none", "parameters")
    from benchmarks.judge.flights import answered

    said = answered(flight.answer)
    rules = next((k for k, row in enumerate(flight.rows) if row.alternative == said), None)
    return Told(
        flight, bool(flight.is_right[best]), quiet, float(p[best]), 0.0 if rules is None else float(p[rules])
    )


def calibration_error(stated: np.ndarray, right: np.ndarray) -> float:
    """Return the expected calibration error over ten groups of equal size."""
    order = np.argsort(stated)
    groups = np.array_split(order, min(_BINS, max(len(order) // 8, 1)))
    return float(sum(len(g) / len(order) * abs(stated[g].mean() - right[g].mean()) for g in groups if len(g)))
