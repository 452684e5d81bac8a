"""The paper's rules under other readings, and two of their flaws, in the campaigns of ``advisor study``.

The first reading of each list is the advisor's. The other readings exist only here.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from statistics import median

import numpy as np

from advisor.aircraft.aircraft import Rule
from advisor.bundled.study.campaigns import (
    NOISE_PERCENT,
    ORDER,
    TABLE_1,
    CampaignBlock,
    Outcomes,
    Scene,
    fly_campaigns,
    judge,
    table_blocks,
)
from advisor.bundled.study.run import Study, StudyReport
from advisor.bundled.study.text import count, wrapped
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


Needed = Mapping[tuple[str, Rule], tuple[int | None, ...]]
"""Name of the reading and rule to the manoeuvres that each campaign needed."""


def needed_by_reading(campaigns: Sequence[Sequence[Estimate]]) -> Needed:
    """Return the number of manoeuvres of each campaign under every interpretation, by interpretation and
    rule."""
    return {
        (reading.name, rule): tuple(_needed(campaign, accepting, reading) for campaign in campaigns)
        for reading in READINGS
        for rule, accepting in reading.accepting.items()
    }


def compare(blocks: Sequence[Needed], noise_percent: float) -> list[ReadingResult]:
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


MOST_CAMPAIGNS = 100
"""Number of campaigns that suffices for a fraction close to one."""
NEAR_ZERO_NOISE_PERCENT = NOISE_PERCENT[0]
"""Noise of the campaigns with zero Z_q: the paper's smallest."""


@dataclass(frozen=True, slots=True)
class Flaws:
    """Sizes of both flaws of the paper's rules."""

    thrown_away_percent: float
    """Fraction of equally good manoeuvres, after the first, that Eq. (11) rejects, %."""
    near_zero_campaigns: int
    """Number of campaigns with Z_q = 0."""
    near_zero_never_percent: float
    """Fraction of campaigns with zero Z_q at 1 % noise that Eq. (12) never stops, %."""
    near_zero_information: int | None
    """Median number of manoeuvres that the rule ``information`` needs in campaigns with zero Z_q."""


def near_zero_blocks(campaigns: int, seed: int) -> list[CampaignBlock]:
    """Return campaigns of an aircraft whose Z_q is zero."""
    scene = Scene()
    scene = replace(scene, aircraft=replace(scene.aircraft, Z_q=0.0))
    return table_blocks(scene, NEAR_ZERO_NOISE_PERCENT, min(campaigns, MOST_CAMPAIGNS), seed)


def measure(ordinary: Sequence[Outcomes], near_zero: Sequence[Outcomes]) -> Flaws:
    """Return the sizes of both flaws: the first in the paper's campaigns, the second in campaigns with Z_q =
    0."""
    rejected = [campaign.rejected / (len(ORDER) - 1) for block in ordinary for campaign in block["separate"]]
    never = [campaign.needed is None for block in near_zero for campaign in block["continuous"]]
    needed = sorted(campaign.needed or np.inf for block in near_zero for campaign in block["information"])
    middle = needed[len(needed) // 2]
    ended = None if np.isinf(middle) else int(middle)
    return Flaws(100.0 * float(np.mean(rejected)), len(never), 100.0 * float(np.mean(never)), ended)


Judged = tuple[Outcomes, Needed]
"""Outcomes of a block by the advisor's reading, and the manoeuvres needed by every reading."""


def judge_readings(block: CampaignBlock) -> Judged:
    """Fly the campaigns of a block, and stop each by every rule in every reading."""
    return judge(block), needed_by_reading(fly_campaigns(block))


def paper(campaigns: int, seed: int) -> Study[CampaignBlock, Judged]:
    """Return the study of the paper's rules: other readings, and two flaws."""
    levels = {noise: table_blocks(Scene(), noise, campaigns, seed) for noise in NOISE_PERCENT}
    blocks = [block for level in levels.values() for block in level]

    def report(results: Sequence[Judged]) -> StudyReport:
        by_noise = {
            noise: [
                judged for block, judged in zip(blocks, results, strict=False) if block.noise_percent == noise
            ]
            for noise in NOISE_PERCENT
        }
        sizes = measure(
            [outcomes for outcomes, _ in by_noise[NEAR_ZERO_NOISE_PERCENT]],
            [outcomes for outcomes, _ in results[len(blocks) :]],
        )
        compared = [
            result
            for noise, judged in by_noise.items()
            for result in compare([needed for _, needed in judged], noise)
        ]
        document = {
            "schema": "advisor.study.paper/1",
            "campaigns": campaigns,
            "flaws": asdict(sizes),
            "readings": [asdict(result) for result in compared],
        }
        return StudyReport([*_flaws(sizes), *_readings(compared)], document)

    return Study([*blocks, *near_zero_blocks(campaigns, seed)], judge_readings, report)


def _flaws(sizes: Flaws) -> list[str]:
    """Return lines on flaws of the paper's rules that users must know."""
    return [
        "Two flaws of the paper's rules:",
        *wrapped(
            f"  separate computation rejects {sizes.thrown_away_percent:.0f} % of equally good manoeuvres: "
            "a new cost is as likely above the median of the earlier ones as below."
        ),
        *wrapped(
            "  a parameter near zero keeps Eq. (12) from falling: with Z_q = 0 and "
            f"{NEAR_ZERO_NOISE_PERCENT:g} % noise, {sizes.near_zero_never_percent:.0f} % of "
            f"{sizes.near_zero_campaigns} campaigns never end; the rule information ends them after "
            f"{count(sizes.near_zero_information)} (median)."
        ),
        "",
    ]


def _readings(results: Iterable[ReadingResult]) -> list[str]:
    """Return lines on the results by other readings of the paper's rules."""
    lines = wrapped(
        "Other readings of the rules: the median number of manoeuvres that the rule needs, the share of "
        "campaigns that never stop, and the share that stops at the paper's number"
    )
    lines += [
        f"  {r.reading:<25}{r.rule:<11}{r.noise_percent:>4g} %{count(r.median):>6}  never "
        f"{r.never_percent:3.0f} %  as paper {r.as_paper_percent:3.0f} %"
        for r in results
    ]
    return [*lines, ""]
