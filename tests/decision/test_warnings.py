"""What the criterion alone does not show."""

import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.stopping import flight_test
from tests.decision.campaigns import THETA, estimate

PLAN = CampaignPlan(rule="continuous", criterion="eq12", limit_percent=25.0, window=3)


@pytest.mark.parametrize(("percent", "is_said"), [(4.0, False), (6.0, True)])
def test_five_sigma_of_one_manoeuvre_beyond_the_limit_will_hardly_fall(percent, is_said):
    history = [CandidateManeuver(estimate(factor * THETA, std_percent=percent)) for factor in (1.0, 1.1, 0.9)]
    said = [text for text in flight_test(history, PLAN).warnings if "hardly fall below 25 %" in text]
    assert bool(said) == is_said
