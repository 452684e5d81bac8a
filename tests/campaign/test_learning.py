"""What a campaign learns of its instruments, and what becomes of verdicts that knew less."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Elevator
from advisor.campaign.axis_campaign import AxisCampaign, ElevatorCampaign
from advisor.campaign.joint_estimate import lag_said, learnt, of_another_power_on
from advisor.campaign.state import NOTHING
from advisor.decision.history import CandidateManeuver
from advisor.decision.stopping import flight_test
from advisor.oem.estimate import InstrumentEstimate
from advisor.oem.known_instruments import FoundInstruments, found_of, with_found
from advisor.process.parts import Parts
from tests.campaign.side_builders import judged
from tests.decision.campaigns import THETA, estimate, with_change


def found(lag_s, std_s, delay_s=0.0, delay_std_s=0.002):
    values, std = np.array([lag_s, delay_s]), np.array([std_s, delay_std_s])
    return FoundInstruments(("servo_lag_s", "command_delay_s"), values, std, np.eye(8), None)


def with_lag(lag_s, std_s, **changed):
    instruments = (InstrumentEstimate("servo_lag_s", lag_s, std_s),)
    return replace(
        estimate(), instruments=instruments, servo_lag_s=lag_s, found=found(lag_s, std_s), **changed
    )


def lag_of(aircraft):
    return found_of(aircraft).value("servo_lag_s")


def test_a_lag_known_to_a_tenth_is_learnt():
    assert lag_of(learnt(Aircraft(), with_lag(0.14, 0.01))) == 0.14


@pytest.mark.parametrize("model", [None, estimate(), with_lag(0.14, 0.02)])
def test_a_lag_that_is_unknown_or_unsure_is_not_learnt(model):
    nothing = Aircraft()
    assert learnt(nothing, model) is nothing


def against(stated_s, told_s, std_s, *, contradicts):
    value_s = told_s if contradicts else stated_s
    lag = InstrumentEstimate("servo_lag_s", value_s, std_s, stated_s, told_s, std_s, contradicts)
    return replace(estimate(), instruments=(lag,), servo_lag_s=value_s, found=found(value_s, std_s))


GIVEN = Aircraft(elevator=Elevator(lag_s=0.14))


def test_a_lag_that_the_crew_gives_stands_while_the_data_do_not_exclude_it():
    now = found_of(learnt(GIVEN, against(0.14, 0.15, 0.01, contradicts=False)))
    assert now.values[0] == pytest.approx(0.14)
    assert now.std[0] == pytest.approx(0.01)
    assert learnt(GIVEN, estimate()) is GIVEN


def test_a_lag_that_the_data_tell_takes_the_place_of_an_excluded_one():
    now = learnt(GIVEN, against(0.14, 0.22, 0.004, contradicts=True))
    assert lag_of(now) == 0.22
    assert "0.220 s, against 0.140 s in elevator.lag_s" in lag_said(now)


def test_the_crew_s_lag_returns_when_later_manoeuvres_agree_with_it():
    misled = learnt(GIVEN, against(0.14, 0.22, 0.004, contradicts=True))
    back = learnt(misled, against(0.14, 0.15, 0.01, contradicts=False))
    assert lag_of(back) == pytest.approx(0.14)
    assert "as elevator.lag_s says" in lag_said(back)


def test_a_surer_value_of_the_same_lag_is_news():
    used = learnt(Aircraft(), with_lag(0.14, 0.01))
    assert found_of(learnt(used, with_lag(0.14, 0.004))).std[0] == 0.004


def test_the_delay_of_the_command_holds_within_its_power_on_alone():
    told_of = with_found(Aircraft(), found(0.1, 0.01))
    assert found_of(of_another_power_on(told_of)).names == ("servo_lag_s",)
    several = learnt(Aircraft(), with_lag(0.14, 0.01), one_power_on=False)
    assert found_of(several).names == ("servo_lag_s",)


def test_a_lag_within_its_own_error_of_the_one_used_changes_nothing_but_at_the_end():
    used = learnt(Aircraft(), with_lag(0.14, 0.01))
    assert learnt(used, with_lag(0.145, 0.01)) is used
    assert lag_of(learnt(used, with_lag(0.145, 0.01), exactly=True)) == 0.145


def test_the_same_values_with_the_same_errors_change_nothing_at_the_end_either():
    used = learnt(Aircraft(), with_lag(0.14, 0.01))
    assert learnt(used, with_lag(0.14, 0.01), exactly=True) is used
    assert learnt(used, with_lag(0.14, 0.009), exactly=True) is not used


def test_a_lag_that_reads_as_before_is_not_said_again(monkeypatch):
    said = []
    campaign = ElevatorCampaign(Aircraft(), said.append, Parts())
    monkeypatch.setattr(ElevatorCampaign, "_judge", lambda self: None)
    for lag_s, std_s in ((0.1431, 0.012), (0.1432, 0.005), (0.151, 0.004)):
        monkeypatch.setattr(ElevatorCampaign, "_of_lag", with_lag(lag_s, std_s))
        campaign._learn()
    assert [sentence.split(" by all")[0] for sentence in said] == [
        "the servo's lag is 0.143 s", "the servo's lag is 0.151 s"
    ]  # fmt: skip
    assert lag_of(campaign.learnt) == 0.151


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
