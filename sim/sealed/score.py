"""Scores of judged answers: rates with 95 % intervals. The table is equal for every generator."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .judge import NO_ANSWER, Z95, Judged

MODERATE_GAP = 0.2
"""Least structural gap above the noise of a moderate effect."""

FAST_S = 5.0
"""Largest processor time of a fast diagnosis, s."""
BINS = 10
HARD = "right cause first, hard, moderate or stronger"
"""Table row of the hard cases with an effect that is large enough to see."""


@dataclass(frozen=True)
class Rate:
    """A share of cases, or a median, with its 95 % interval (Wilson's for shares, bootstrap for medians)."""

    name: str
    value: float
    low: float
    high: float
    count: int
    goal: str
    hits: int | None = None
    """Number of right cases, for a share. None for a median or an error."""

    def line(self) -> str:
        """Return one row of the table. Values are in percent unless the goal has another unit."""
        if not self.count:
            return f"{self.name:52s}       no case              goal {self.goal}"
        figures = f"{self.value:7.1f} [{self.low:5.1f}, {self.high:5.1f}]  n={self.count:<5d}"
        return f"{self.name:52s} {figures} goal {self.goal}"


def score(judged: Sequence[Judged]) -> list[Rate]:
    """Return every figure of the table."""
    one = _of("one", judged)
    clean, hard = ([j for j in one if j.condition == name] for name in ("clean", "hard"))
    moderate = [j for j in hard if j.gap is None or j.gap >= MODERATE_GAP]
    named = [j for j in judged if j.verdict == "effect" and j.kind != "two"]
    named_in_hard = [j for j in hard if j.verdict == "effect"]
    outside = _of("outside", judged)
    return [
        share("usable", (j.verdict != NO_ANSWER for j in judged), "all"),
        share("right cause first, one effect", (j.names_the_cause for j in one), ""),
        share("right cause first, clean", (j.names_the_cause for j in clean), ">= 98"),
        share("  the first cause, or a stated confusion", (j.names_or_confuses for j in clean), ""),
        share(HARD, (j.names_the_cause for j in moderate), ">= 95"),
        share("  the first cause, or a stated confusion", (j.names_or_confuses for j in moderate), ""),
        *_by_condition(one),
        share("a named cause is right (hard)", (j.names_the_cause for j in named_in_hard), ">= 98"),
        share("  the same, or the air it was flown in", (j.names_what_acted for j in named_in_hard), ""),
        share("a named cause is right (all but two effects)", (j.names_the_cause for j in named), ""),
        share("false alarms without an effect", (j.is_alarm for j in _of("none", judged)), "<= 1"),
        share(
            "true of the log and not asked for, named first",
            (j.first in j.also_true for j in judged if j.also_true),
            "",
        ),
        share(
            "parameters told when only they are off",
            (j.verdict == "parameters" for j in _of("parameters", judged)),
            "",
        ),
        share("outside the catalogue: unknown", (j.verdict == "unknown" for j in outside), ">= 90"),
        share("outside the catalogue: right block", (j.finds_the_block for j in outside), ">= 97"),
        share("named effects: right block", (j.finds_the_block for j in one), ""),
        share("two effects: both named", (j.names_both for j in _of("two", judged)), ">= 90"),
        _median(
            "held-out shrink, right cause, clean (median %)", [j for j in clean if j.names_the_cause], ">= 97"
        ),
        _median(
            "held-out shrink, right cause, hard (median %)", [j for j in hard if j.names_the_cause], ">= 90"
        ),
        share(
            "size within its stated 95 % interval",
            (inside for j in one if j.names_the_cause for inside in j.sizes_inside()),
            "92..98",
        ),
        *_own_simulator(_of("simulator", judged)),
        _calibration_error(named),
        _shuffled(one),
    ]


def _of(kind: str, judged: Sequence[Judged]) -> list[Judged]:
    return [j for j in judged if j.kind == kind]


def _by_condition(one: Sequence[Judged]) -> list[Rate]:
    """Return the share of right causes in each condition except the clean one."""
    return [
        share(
            f"right cause first, {name}",
            (j.names_the_cause for j in one if j.condition == name),
            ">= 95" if name == "JSBSim" else "",
        )
        for name in sorted({j.condition for j in one} - {"clean"})
    ]


def _own_simulator(judged: Sequence[Judged]) -> list[Rate]:
    """Return the figures of the cases with a user's own simulator."""
    withheld, none = [j for j in judged if j.truth], [j for j in judged if not j.truth]
    shrunk = [
        replace(j, shrink_percent=j.simulator_percent) for j in withheld if j.names_the_cause and _adds(j)
    ]
    return [
        share("own simulator: right cause first", (j.names_the_cause for j in withheld), ">= 90"),
        share("own simulator, unchanged: none or numbers", (j.is_left_alone for j in none), ">= 98"),
        _median("own simulator: held-out shrink in it (median %)", shrunk, ">= 90"),
    ]


def _adds(j: Judged) -> bool:
    """Return whether the right correction adds an effect to the simulator, instead of removing a servo."""
    return all(value >= 0.0 for name, value in j.sizes[j.truth[0]].items() if name in ("lag_s", "delay_s"))


def by_effect(judged: Sequence[Judged]) -> list[Rate]:
    """Return the share of right first causes for each effect, over the cases with one effect."""
    one = _of("one", judged)
    return [
        share(f"  {name}", (j.names_the_cause for j in one if j.truth[0] == name), "")
        for name in sorted({j.truth[0] for j in one})
    ]


def in_time(seconds: Sequence[float]) -> Rate:
    """Return the share of answers within the allowed processor time."""
    return share(f"CPU seconds at most {FAST_S:g}", (s <= FAST_S for s in seconds), "all")


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """Return the limits of a share's 95 % interval (Wilson, 1927), from 0 to 1."""
    part, squared = hits / trials, Z95**2
    middle = (part + squared / (2 * trials)) / (1 + squared / trials)
    half = Z95 / (1 + squared / trials) * math.sqrt(part * (1 - part) / trials + squared / (4 * trials**2))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def share(name: str, hits: Iterable[bool], goal: str) -> Rate:
    """Return the share of hits with its 95 % interval."""
    told = list(hits)
    if not told:
        return Rate(name, math.nan, math.nan, math.nan, 0, goal, 0)
    low, high = wilson(sum(told), len(told))
    return Rate(name, 100 * sum(told) / len(told), 100 * low, 100 * high, len(told), goal, sum(told))


def _median(name: str, judged: Sequence[Judged], goal: str) -> Rate:
    values = np.array([j.shrink_percent for j in judged if math.isfinite(j.shrink_percent)])
    if not len(values):
        return Rate(name, math.nan, math.nan, math.nan, 0, goal)
    drawn = np.random.default_rng(0).choice(values, (2000, len(values)))
    low, high = np.percentile(np.median(drawn, axis=1), [2.5, 97.5])
    return Rate(name, float(np.median(values)), float(low), float(high), len(values), goal)


def _calibration_error(judged: Sequence[Judged]) -> Rate:
    """Return the expected calibration error of the first cause's probability, in percent, over ten equal
    bins."""
    name, goal = "expected calibration error of probabilities", "<= 5"
    if not judged:
        return Rate(name, math.nan, math.nan, math.nan, 0, goal)
    said = np.array([j.probability for j in judged])
    right = np.array([j.names_the_cause for j in judged], dtype=float)

    def error(index: Any) -> float:
        p, r = said[index], right[index]
        bins = np.minimum((p * BINS).astype(int), BINS - 1)
        gaps = [
            abs(p[bins == b].mean() - r[bins == b].mean()) * (bins == b).mean()
            for b in range(BINS)
            if (bins == b).any()
        ]
        return float(sum(gaps))

    whole = np.arange(len(said))
    drawn = [error(np.random.default_rng(i).choice(whole, len(whole))) for i in range(300)]
    low, high = np.percentile(drawn, [2.5, 97.5])
    return Rate(name, 100 * error(whole), 100 * float(low), 100 * float(high), len(said), goal)


def _shuffled(judged: Sequence[Judged]) -> Rate:
    """Return the share of right first causes for shuffled labels, which is the chance level."""
    generator = np.random.default_rng(0)
    hits: list[bool] = []
    for _ in range(20 if judged else 0):
        order = generator.permutation(len(judged))
        hits += [a.first == judged[int(b)].truth[0] for a, b in zip(judged, order, strict=True)]
    return share("label shuffle: right by chance (20 shuffles)", hits, "chance")
