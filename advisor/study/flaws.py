"""The two flaws of the paper's rules that the study reveals, measured, because users must know them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft import CampaignPlan
from advisor.decision.acceptance import separate_computation
from advisor.oem.estimate import Estimate
from advisor.study.campaigns import fly_campaigns, outcome
from advisor.study.estimating import Advance
from advisor.study.flying import Scene, as_maneuver, fly_named
from advisor.study.paper import ORDER

MOST_CAMPAIGNS = 100
"""Enough for a share of practically one."""
NOISE_PERCENT = 1.0


@dataclass(frozen=True, slots=True)
class Flaws:
    """Both flaws in numbers."""

    thrown_away_percent: float
    """Share of equally good manoeuvres, after the first, that Eq. (11) rejects."""
    near_zero_campaigns: int
    """How many campaigns were flown with Z_q = 0."""
    near_zero_never_percent: float
    """Share of campaigns at 1 % noise that Eq. (12) never ends when Z_q is zero."""
    near_zero_information: int | None
    """Median number of manoeuvres the rule ``information`` needs for the same campaigns."""


def measure(campaigns: Sequence[Sequence[Estimate]], seed: int, advance: Advance | None = None) -> Flaws:
    """Measure the first flaw on campaigns that were flown already, the second on an aircraft with Z_q = 0."""
    verdicts = [separate_computation([e.cost for e in campaign])[1:] for campaign in campaigns]
    thrown_away = 100.0 * float(np.mean([not result.accepted for v in verdicts for result in v]))
    scene = Scene()
    scene = replace(scene, aircraft=replace(scene.aircraft, Z_q=0.0))
    count = min(len(campaigns), MOST_CAMPAIGNS)
    near_zero = fly_campaigns(scene, NOISE_PERCENT, count, seed, advance=advance)
    plan = CampaignPlan()
    maneuvers = [as_maneuver(fly_named(scene, name)) for name in ORDER]
    never = [outcome(c, "continuous", plan).needed is None for c in near_zero]
    needed = sorted(outcome(c, "information", plan, maneuvers).needed or np.inf for c in near_zero)
    middle = needed[len(needed) // 2]
    ended = None if np.isinf(middle) else int(middle)
    return Flaws(thrown_away, count, 100.0 * float(np.mean(never)), ended)
