"""A verdict that later manoeuvres change stands in a line of its own, on the manoeuvre and on the newest
one."""

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.campaign.axis_campaign import AxisCampaign
from advisor.campaign.hand_decisions import NOTHING
from advisor.decision.history import CandidateManeuver
from advisor.decision.stopping import flight_test
from advisor.process.parts import Parts
from tests.campaign.side_builders import judged
from tests.decision.campaigns import THETA, estimate, with_change


class Told(AxisCampaign):
    """A campaign of hand-made estimates."""

    theta = THETA

    def fly(self, number, theta):
        self.theta = theta
        self.take(judged(number, "aileron").maneuver, NOTHING)

    def _examined(self, maneuver):
        return CandidateManeuver(estimate(self.theta))

    def _decided(self, history, heard):
        return flight_test(history[:0], self._plan)


def campaign(*thetas):
    found = Told("pitch", Aircraft(), CampaignPlan(), Parts())
    for number, theta in enumerate(thetas, 1):
        found.fly(number, theta)
    return found


ODD = with_change("M_alpha", 1.5)


def test_an_acceptance_that_later_manoeuvres_take_back_is_said_on_the_manoeuvre():
    found = campaign(ODD, THETA, THETA, THETA)
    caution = found.judged[0].verdict.cautions[0]
    assert caution.startswith("accepted before, refused since manoeuvre 4: contradicts all the others")
    assert [one.verdict.cautions for one in found.judged[1:]] == [()] * 3


def test_a_changed_verdict_is_said_once_when_the_manoeuvre_that_changed_it_is_announced():
    found = campaign(ODD, THETA, THETA, THETA)
    (said,) = found.take_revisions()
    assert said.startswith("manoeuvre 1: accepted before, refused since manoeuvre 4")
    found.fly(5, THETA)
    assert found.take_revisions() == ()


def test_an_exclusion_by_hand_is_no_changed_verdict():
    found = campaign(THETA, THETA)
    found.exclude(1, "gust")
    found.fly(3, THETA)
    assert found.take_revisions() == ()
