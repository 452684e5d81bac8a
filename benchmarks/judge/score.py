"""Scores of the judge and of the rules, each generator judged by a fit on the others."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.judge.logit import Logit
from advisor.gap.judge.posterior import posterior
from advisor.gap.judge.prior import FieldPrior
from benchmarks.judge.fit import fitted, flown_prior
from benchmarks.judge.flights import JudgedFlight, answered, is_true

SURE = 0.9
"""Probability from which an answer is called sure."""
_GROUPS = 10
_LEAST_IN_A_GROUP = 8

Decide = Callable[[JudgedFlight, Logit, FieldPrior], tuple[Alternative, float]]
"""Function that returns the first answer to a flight, and its stated probability."""


@dataclass(frozen=True)
class Told:
    """A first answer with its stated probability."""

    flight: JudgedFlight
    answer: Alternative
    probability: float

    @property
    def is_right(self) -> bool:
        """Whether the answer is right."""
        return is_true(self.answer, self.flight.truth)

    @property
    def is_alarm(self) -> bool:
        """Whether something is claimed where nothing is."""
        return self.flight.truth["kind"] == "none" and self.answer.kind != "none" and not self.is_right


def by_rules(flight: JudgedFlight, logit: Logit, prior: FieldPrior) -> tuple[Alternative, float]:
    """Return the answer of the rules, with the judge's probability."""
    said = answered(flight.answer)
    return said, posterior(flight.rows, prior, logit).of(said)


def by_judge(flight: JudgedFlight, logit: Logit, prior: FieldPrior) -> tuple[Alternative, float]:
    """Return the likeliest first cause, with its probability."""
    return posterior(flight.rows, prior, logit).first_causes[0]


def left_out(flights: Sequence[JudgedFlight], decide: Decide, prior: FieldPrior | None = None) -> list[Told]:
    """Return the answers to each generator's flights, from a fit on the others.

    ``prior``: field prior of the answers; None: the shares among that generator's own flights.
    """
    told = []
    for generator in sorted({flight.generator for flight in flights}):
        theirs = [f for f in flights if f.generator == generator]
        logit = fitted([f for f in flights if f.generator != generator])
        at = prior or flown_prior(theirs)
        told += [Told(flight, *decide(flight, logit, at)) for flight in theirs]
    return told


def table(flights: Sequence[JudgedFlight]) -> str:
    """Return the table of the scores, rules and judge, by generator."""
    columns = "answer", "generator", "right", "P ≥ .9 right", "calibration error", "Brier", "false alarms"
    lines = [f"| {' | '.join(columns)} |", f"{'|---' * len(columns)}|"]
    for name, decide in (("rules", by_rules), ("judge", by_judge)):
        told = left_out(flights, decide)
        generators = sorted({t.flight.generator for t in told})
        lines += [_line(name, g, [t for t in told if t.flight.generator == g]) for g in generators]
        lines.append(_line(name, "all", told))
    return "\n".join(lines)


def _line(name: str, generator: str, told: Sequence[Told]) -> str:
    right = np.array([t.is_right for t in told], float)
    stated = np.array([t.probability for t in told])
    sure = stated >= SURE
    quiet = [t for t in told if t.flight.truth["kind"] == "none"]
    parts = (
        name, generator, f"{int(right.sum())} of {len(told)}",
        f"{int(right[sure].sum())} of {int(sure.sum())}", f"{calibration_error(stated, right):.3f}",
        f"{float(np.mean((stated - right) ** 2)):.3f}", f"{sum(t.is_alarm for t in quiet)} of {len(quiet)}",
    )  # fmt: skip
    return f"| {' | '.join(parts)} |"


def calibration_error(stated: np.ndarray, right: np.ndarray) -> float:
    """Return the expected calibration error over groups of equal size."""
    groups = np.array_split(np.argsort(stated), max(min(_GROUPS, len(stated) // _LEAST_IN_A_GROUP), 1))
    return float(sum(len(g) / len(stated) * abs(stated[g].mean() - right[g].mean()) for g in groups))
