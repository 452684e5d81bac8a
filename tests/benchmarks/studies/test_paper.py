"""Other readings of the paper's rules, and two of their flaws, in small numbers."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.bundled.study.campaigns import CampaignBlock, Scene, fly_campaigns, judge, outcome, table_blocks
from advisor.oem.estimate import Estimate
from benchmarks.studies.paper import compare, measure, near_zero_blocks, needed_by_reading

SCENE = Scene()
CAMPAIGNS = 40


@pytest.fixture(scope="module")
def flown() -> list[list[Estimate]]:
    """Forty campaigns at 1 % noise."""
    return fly_campaigns(CampaignBlock(SCENE, 1.0, CAMPAIGNS, (1, 1000)))


def test_the_readings_of_the_advisor_are_the_rules_themselves(flown: list[list[Estimate]]) -> None:
    ours = [r for r in compare([needed_by_reading(flown)], 1.0) if r.reading == "as the advisor does"]
    for result in ours:
        needed = [outcome(c, result.rule, CampaignPlan()).needed for c in flown]
        assert result.never_percent == 100.0 * np.mean([n is None for n in needed])


def test_a_window_of_four_cannot_stop_after_three(flown: list[list[Estimate]]) -> None:
    four = [r for r in compare([needed_by_reading(flown)], 1.0) if r.reading == "(12): n + 1 members"]
    assert {r.as_paper_percent for r in four} == {0.0}


def test_both_flaws_of_the_papers_rules_show() -> None:
    ordinary, near_zero = table_blocks(SCENE, 1.0, CAMPAIGNS, seed=1), near_zero_blocks(CAMPAIGNS, 1)
    sizes = measure([judge(block) for block in ordinary], [judge(block) for block in near_zero])
    assert sizes.thrown_away_percent == pytest.approx(50.0, abs=8.0)
    assert sizes.near_zero_campaigns == CAMPAIGNS
    assert sizes.near_zero_never_percent > 90.0
    assert sizes.near_zero_information is not None
