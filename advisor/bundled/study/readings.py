"""Figures that the paper prints, and other readings of its rules, compared by their reproduction of Table 1.

The first reading of each list is the advisor's. The other readings exist only in the study.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from advisor.aircraft.aircraft import Rule
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.paper_rules import (
    ALLOWED_INCREASE,
    Costs,
    continuous_improvement,
    scatter_percent,
    separate_computation,
)
from advisor.decision.verdict import RuleResult
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray

NOISE_PERCENT = (1.0, 2.5, 5.0)
ORDER = ("3211", "rev", "rev", "3211", "rev", "3211", "rev")
"""Inputs of the seven manoeuvres of the campaign."""


@dataclass(frozen=True, slots=True)
class PaperRow:
    """One row of Table 1 of the paper."""

    needed: int | None
    """Number of manoeuvres until the stop. None: the campaign never stopped."""
    error_percent: Mapping[str, float]
    """Error of each parameter in percent of its true value."""


def _row(needed: int | None, *errors: float) -> PaperRow:
    return PaperRow(needed, dict(zip(PARAMETERS, errors, strict=True)))


TABLE_1: Mapping[tuple[Rule, float], PaperRow] = {
    ("continuous", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.15, 0.56, 0.07),
    ("continuous", 2.5): _row(7, 0.87, 0.74, 6.38, 3.35, 0.73, 0.10, 1.69, 1.21),
    ("continuous", 5.0): _row(None, 0.07, 5.50, 16.37, 0.89, 2.18, 2.35, 1.28, 0.70),
    ("separate", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.14, 0.56, 0.07),
    ("separate", 2.5): _row(4, 0.29, 2.79, 3.59, 0.70, 1.19, 0.60, 1.82, 0.88),
    ("separate", 5.0): _row(4, 5.43, 4.86, 30.85, 9.41, 1.26, 0.56, 3.46, 1.20),
}


Accepting = Callable[[Sequence[float]], list[bool]]


def continuous_against_last_flown(costs: Sequence[float]) -> list[bool]:
    """Apply Eq. (10) with i − 1 the last manoeuvre flown, accepted or not."""
    return [i == 0 or cost < ALLOWED_INCREASE * costs[i - 1] for i, cost in enumerate(costs)]


def separate_among_accepted(costs: Sequence[float]) -> list[bool]:
    """Apply Eq. (11) with only accepted manoeuvres in the median."""
    kept: list[float] = []
    verdicts = []
    for cost in costs:
        good = not kept or cost < median(kept)
        verdicts.append(good)
        if good:
            kept.append(cost)
    return verdicts


def _ours(rule: Callable[[Costs], Sequence[RuleResult]]) -> Accepting:
    return lambda costs: [result.accepted for result in rule(costs)]


def population_scatter(theta: FloatArray) -> float:
    """Apply Eq. (12) with n instead of n − 1 in the standard deviation."""
    return scatter_percent(theta) * float(np.sqrt((len(theta) - 1) / len(theta)))


def largest_scatter(theta: FloatArray) -> float:
    """Apply Eq. (12) with the largest parameter instead of the Euclidean norm."""
    return 500.0 * float(np.max(theta.std(axis=0, ddof=1) / np.abs(theta.mean(axis=0))))


def written_out(theta: FloatArray) -> float:
    """Apply Eq. (13) of the paper."""
    return scatter_percent(theta, "eq13")


@dataclass(frozen=True, slots=True)
class PaperReading:
    """One interpretation of the paper, which differs from the advisor's in a single point."""

    name: str
    accepting: Mapping[Rule, Accepting]
    criterion: Callable[[FloatArray], float] = scatter_percent
    members: int = 3


_OURS: Mapping[Rule, Accepting] = {
    "continuous": _ours(continuous_improvement),
    "separate": _ours(separate_computation),
}

READINGS = (
    PaperReading("as the advisor does", _OURS),
    PaperReading("(10): last flown", {**_OURS, "continuous": continuous_against_last_flown}),
    PaperReading("(11): median of accepted", {**_OURS, "separate": separate_among_accepted}),
    PaperReading("(12): n + 1 members", _OURS, members=4),
    PaperReading("(12): divided by n", _OURS, population_scatter),
    PaperReading("(12): largest, not norm", _OURS, largest_scatter),
    PaperReading("(13) as written out", _OURS, written_out),
)


@dataclass(frozen=True, slots=True)
class ReadingResult:
    """Result of one interpretation in one row of Table 1."""

    reading: str
    rule: Rule
    noise_percent: float
    median: int | None
    never_percent: float
    as_paper_percent: float
    """Fraction of campaigns that need exactly the paper's number of manoeuvres, %."""


def needed_by_reading(
    campaigns: Sequence[Sequence[Estimate]],
) -> dict[tuple[str, Rule], tuple[int | None, ...]]:
    """Return the number of manoeuvres of each campaign under every interpretation, by interpretation and
    rule."""
    return {
        (reading.name, rule): tuple(_needed(campaign, accepting, reading) for campaign in campaigns)
        for reading in READINGS
        for rule, accepting in reading.accepting.items()
    }


def compare(
    blocks: Sequence[Mapping[tuple[str, Rule], tuple[int | None, ...]]], noise_percent: float
) -> list[ReadingResult]:
    """Return the results of every interpretation of the paper over all blocks at one noise level."""
    results = []
    for name, rule in blocks[0]:
        needed = [number for block in blocks for number in block[name, rule]]
        ordered = sorted(np.inf if n is None else n for n in needed)
        middle = ordered[len(ordered) // 2]
        results.append(
            ReadingResult(
                name,
                rule,
                noise_percent,
                None if np.isinf(middle) else int(middle),
                100.0 * float(np.mean([n is None for n in needed])),
                100.0 * float(np.mean([n == TABLE_1[rule, noise_percent].needed for n in needed])),
            )
        )
    return results


def _needed(campaign: Sequence[Estimate], accepting: Accepting, reading: PaperReading) -> int | None:
    taken: list[FloatArray] = []
    for number, good in enumerate(accepting([e.cost for e in campaign]), start=1):
        if good:
            taken.append(campaign[number - 1].theta)
        if len(taken) >= reading.members and reading.criterion(np.array(taken[-reading.members :])) < 25.0:
            return number
    return None
