"""Measures of two flaws of the paper's rules that users must know."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.bundled.study.campaigns import CampaignBlock, CampaignResults, joined, table_blocks
from advisor.bundled.study.flying import Scene
from advisor.bundled.study.readings import ORDER

MOST_CAMPAIGNS = 100
"""Number of campaigns that suffices for a fraction close to one."""
NOISE_PERCENT = 1.0


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
    return table_blocks(scene, NOISE_PERCENT, min(campaigns, MOST_CAMPAIGNS), seed)


def measure(ordinary: Sequence[CampaignResults], near_zero: Sequence[CampaignResults]) -> Flaws:
    """Return the sizes of both flaws: the first in the paper's campaigns, the second in campaigns with Z_q =
    0."""
    rejected = [one.rejected / (len(ORDER) - 1) for one in joined(ordinary, "separate")]
    never = [one.needed is None for one in joined(near_zero, "continuous")]
    needed = sorted(one.needed or np.inf for one in joined(near_zero, "information"))
    middle = needed[len(needed) // 2]
    ended = None if np.isinf(middle) else int(middle)
    return Flaws(100.0 * float(np.mean(rejected)), len(never), 100.0 * float(np.mean(never)), ended)
