"""Score a diagnosis of sealed cases: rates with 95 % intervals."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

MODERATE_GAP = 0.2
"""Least structural gap above the noise of a moderate effect."""

FAST_S = 5.0
"""Largest processor time of a fast diagnosis, s."""
Z95 = 1.959964
BINS = 10
_FINE = ("none", "parameters")
"""Verdicts on an unchanged simulator that are no false alarm."""


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


@dataclass(frozen=True)
class Judged:
    """A case's truth, with the answer to it."""

    group: str
    truth: tuple[str, ...]
    blocks: tuple[str, ...]
    sizes: Mapping[str, Mapping[str, float]]
    gap: float
    hard: bool
    background: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    """Effects of ``causes``, best first."""
    added: tuple[str, ...]
    """Effects of the answer's waterfall."""
    probability: float
    parameters: Mapping[str, Mapping[str, float]]
    """Parameters of the first cause."""
    confusions: tuple[str, ...]
    block: str
    shrink_percent: float
    simulator_percent: float
    """Shrinkage of the gap in the user's own simulator, percent. NaN without one."""

    @property
    def right(self) -> bool:
        """Whether the first cause is the true one. Without an effect in a hard case, the air is the true
        cause."""
        truth = self.truth or self.background
        return self.verdict == "effect" and bool(truth) and self.named[:1] == truth[:1]

    @property
    def is_there(self) -> bool:
        """Whether the first cause acted on the flight: the drawn effect, or the air."""
        return self.right or (self.verdict == "effect" and set(self.named[:1]) <= set(self.background))

    @property
    def is_left_alone(self) -> bool:
        """Whether a simulator with a right structure is called right, or wrong in numbers only."""
        return self.group == "simulator" and not self.truth and self.verdict in _FINE

    @property
    def right_or_confused(self) -> bool:
        """Whether the true cause is first, or is stated as indistinguishable from the first."""
        return self.right or (self.verdict == "effect" and self.truth[0] in self.confusions)


def judge(key: Mapping[str, Any], answers: Mapping[str, Mapping[str, Any]]) -> list[Judged]:
    """Compare answers (``advisor gap --json`` documents by case) with the key. A missing answer counts as
    unknown."""
    judged = []
    for name, truth in key.items():
        answer = answers.get(name, {})
        causes = answer.get("causes") or []
        first = causes[0] if causes else {}
        shrunk = answer.get("shrink") or {}
        shrink, simulated = shrunk.get("percent"), (shrunk.get("in_simulator") or {}).get("percent")
        judged.append(
            Judged(
                group=truth["group"],
                truth=tuple(truth["effects"]),
                blocks=tuple(truth["blocks"]),
                sizes=truth["effects"],
                gap=float(truth["gap"]),
                hard=bool(truth["hard"]),
                background=tuple(truth["background"]),
                verdict=str(answer.get("verdict", "unknown")),
                named=tuple(str(cause.get("effect")) for cause in causes),
                added=tuple(str(step.get("effect")) for step in answer.get("waterfall") or []),
                probability=float(first.get("probability") or 0.0),
                parameters=first.get("parameters") or {},
                confusions=tuple(first.get("cannot_be_told_from") or ()),
                block=str((answer.get("where") or {}).get("block", "")),
                shrink_percent=math.nan if shrink is None else float(shrink),
                simulator_percent=math.nan if simulated is None else float(simulated),
            )
        )
    return judged


def score(judged: Sequence[Judged]) -> list[Rate]:
    """Return every figure of the table."""
    single = [j for j in judged if j.group in ("clean", "hard", "jsbsim")]
    clean = [j for j in single if j.group == "clean"]
    hard = [j for j in single if j.group == "hard"]
    moderate = [j for j in hard if j.gap >= MODERATE_GAP]
    engine = [j for j in single if j.group == "jsbsim"]
    none = [j for j in judged if j.group == "none"]
    outside = [j for j in judged if j.group == "outside"]
    two = [j for j in judged if j.group == "two"]
    named = [j for j in judged if j.verdict == "effect" and j.group != "two"]
    named_in_hard = [j for j in hard if j.verdict == "effect"]
    covered = [inside for j in single if j.right for inside in _covered(j)]
    return [
        _share("right cause first, clean", [j.right for j in clean], ">= 98"),
        _share("  the first cause, or a stated confusion", [j.right_or_confused for j in clean], ""),
        _share("right cause first, hard, moderate or stronger", [j.right for j in moderate], ">= 95"),
        _share("  the first cause, or a stated confusion", [j.right_or_confused for j in moderate], ""),
        _share("right cause first, hard, all", [j.right for j in hard], ""),
        _share("a named cause is right (hard)", [j.right for j in named_in_hard], ">= 98"),
        _share("  the same, or the air it was flown in", [j.is_there for j in named_in_hard], ""),
        _share("a named cause is right (all but two effects)", [j.right for j in named], ""),
        _share("right cause first, JSBSim", [j.right for j in engine], ">= 95"),
        _share("false alarms without an effect", [_alarm(j) for j in none], "<= 1"),
        _share(
            "parameters told when only they are off",
            [j.verdict == "parameters" for j in judged if j.group == "parameters"],
            "",
        ),
        _share("outside the catalogue: unknown", [j.verdict == "unknown" for j in outside], ">= 90"),
        _share("outside the catalogue: right block", [j.block in j.blocks for j in outside], ">= 97"),
        _share("named effects: right block", [j.block in j.blocks for j in single], ""),
        _share("two effects: both named", [_both(j) for j in two], ">= 90"),
        _median("held-out shrink, right cause, clean (median %)", [j for j in clean if j.right], ">= 97"),
        _median("held-out shrink, right cause, hard (median %)", [j for j in hard if j.right], ">= 90"),
        _share("size within its stated 95 % interval", covered, "92..98"),
        *_own_simulator([j for j in judged if j.group == "simulator"]),
        _calibration_error([j for j in judged if j.verdict == "effect" and j.group != "two"]),
        _shuffled(single),
    ]


def _own_simulator(judged: Sequence[Judged]) -> list[Rate]:
    """Return the figures of the cases that name a user's own simulator."""
    withheld, none = [j for j in judged if j.truth], [j for j in judged if not j.truth]
    shrunk = [replace(j, shrink_percent=j.simulator_percent) for j in withheld if j.right and _adds(j)]
    return [
        _share("own simulator: right cause first", [j.right for j in withheld], ">= 90"),
        _share("own simulator, unchanged: none or numbers", [j.is_left_alone for j in none], ">= 98"),
        _median("own simulator: held-out shrink in it (median %)", shrunk, ">= 90"),
    ]


def _adds(j: Judged) -> bool:
    """Return whether the truth adds an effect to the simulator, instead of removing a servo from it."""
    return all(value >= 0.0 for name, value in j.sizes[j.truth[0]].items() if name in ("lag_s", "delay_s"))


def by_effect(judged: Sequence[Judged]) -> list[Rate]:
    """Return the share of right first causes for each effect, over clean, hard and JSBSim cases."""
    single = [j for j in judged if j.group in ("clean", "hard", "jsbsim")]
    return [
        _share(f"  {name}", [j.right for j in single if j.truth[0] == name], "")
        for name in sorted({j.truth[0] for j in single})
    ]


def in_time(seconds: Sequence[float]) -> Rate:
    """Return the share of answers within the allowed processor time."""
    return _share(f"CPU seconds at most {FAST_S:g}", [s <= FAST_S for s in seconds], "all")


def is_right(j: Judged) -> bool:
    """Return whether an answer fits its group's question: a cause, both, the block, numbers, or nothing."""
    if j.group == "none":
        return not _alarm(j)
    if j.group == "parameters":
        return j.verdict == "parameters"
    if j.group == "outside":
        return j.verdict == "unknown" and j.block in j.blocks
    return _both(j) if j.group == "two" else j.right


def _alarm(j: Judged) -> bool:
    """Return whether an effect, a change or an unknown was claimed without one. Background turbulence may be
    named."""
    return j.verdict != "none" and not j.is_there


def _both(j: Judged) -> bool:
    return j.verdict == "effect" and set(j.truth) <= {*j.named[:1], *j.added}


def _covered(j: Judged) -> list[bool]:
    """Return, for each size of the key that the answer also gives, whether its 95 % interval holds the
    size."""
    found = []
    for name, true in j.sizes[j.truth[0]].items():
        said = j.parameters.get(name)
        if said and said.get("std") is not None:
            found.append(abs(float(said["value"]) - true) <= Z95 * float(said["std"]))
    return found


def _share(name: str, hits: Sequence[bool], goal: str) -> Rate:
    count = len(hits)
    if not count:
        return Rate(name, math.nan, math.nan, math.nan, 0, goal, 0)
    share, squared = sum(hits) / count, Z95**2
    middle = (share + squared / (2 * count)) / (1 + squared / count)
    half = Z95 / (1 + squared / count) * math.sqrt(share * (1 - share) / count + squared / (4 * count**2))
    low, high = 100 * max(middle - half, 0.0), 100 * min(middle + half, 1.0)
    return Rate(name, 100 * share, low, high, count, goal, sum(hits))


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
    right = np.array([j.right for j in judged], dtype=float)

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
    """Return the share of right first causes with shuffled labels, which is chance."""
    generator = np.random.default_rng(0)
    hits: list[bool] = []
    for _ in range(20 if judged else 0):
        order = generator.permutation(len(judged))
        hits += [
            a.verdict == "effect" and a.named[:1] == judged[int(b)].truth[:1]
            for a, b in zip(judged, order, strict=True)
        ]
    return _share("label shuffle: right by chance (20 shuffles)", hits, "chance")
