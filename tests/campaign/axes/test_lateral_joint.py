"""Which lateral manoeuvres the joint estimate of a flight holds, and when the crew pays for one."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign import axis_campaign
from advisor.campaign.axis_campaign import LateralCampaign
from advisor.campaign.state import NOTHING, ByHand, Remark
from advisor.process.parts import Parts
from tests.campaign.side_builders import estimate, judged


@pytest.fixture
def joint(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Number of manoeuvres of each joint estimate that is made; single ones are not counted."""
    made: list[int] = []

    def estimated(_, maneuvers, *__):
        if len(maneuvers) == 1:
            return estimate(maneuvers[0].span.kind.split()[0], percent=30.0)
        made.append(len(maneuvers))
        return estimate("aileron", "rudder", percent=30.0)

    monkeypatch.setattr(axis_campaign, "estimate_axis", estimated)
    monkeypatch.setattr(axis_campaign, "judge", lambda *_: ())
    return made


def flown(*controls: str, by_hand: ByHand = NOTHING, advises: bool = True) -> LateralCampaign:
    campaign = LateralCampaign(Aircraft(), Parts(), advises)
    for number, control in enumerate(controls, start=1):
        campaign.take(judged(number, control).maneuver, by_hand)
    return campaign


def test_inputs_of_one_control_do_not_make_the_estimate_forget_the_other(joint: list[int]) -> None:
    campaign = flown("rudder", "rudder", "rudder", "rudder", *["aileron"] * 9)
    assert campaign.state().estimate_from == (2, 3, 4, 10, 11, 12, 13)


def test_few_manoeuvres_all_count(joint: list[int]) -> None:
    assert flown("rudder", "aileron", "aileron").state().estimate_from == (1, 2, 3)


def test_at_the_end_all_manoeuvres_count(joint: list[int]) -> None:
    campaign = flown("rudder", *["aileron"] * 9)
    campaign.finish()
    assert campaign.state().estimate_from == tuple(range(1, 11))


def test_a_fuller_record_from_another_log_takes_the_place_of_a_manoeuvre(joint: list[int]) -> None:
    campaign = flown("rudder", "aileron")
    before = campaign.state()
    fuller = replace(campaign.maneuvers[1], flight=1)
    campaign.take_better(fuller, None)
    assert campaign.maneuvers == (campaign.maneuvers[0], fuller)
    assert campaign.state() is not before
    assert joint == [2, 2]


def test_no_joint_estimate_is_made_before_both_controls_were_flown(joint: list[int]) -> None:
    flown("aileron", "aileron", "aileron")
    assert joint == []
    flown("aileron", "aileron", "rudder")
    assert joint == [3]


def test_without_advice_in_flight_the_only_joint_estimate_is_that_of_the_end(joint: list[int]) -> None:
    campaign = flown("rudder", "aileron", "rudder", "aileron", advises=False)
    assert joint == []
    campaign.finish()
    assert campaign.state().estimate_from == (1, 2, 3, 4)
    assert joint == [4]


def test_a_manoeuvre_that_a_hand_excludes_is_no_part_of_the_estimate(joint: list[int]) -> None:
    campaign = flown("rudder", "aileron", "aileron")
    campaign.exclude(2, "the pilot held the wheel")
    assert campaign.state().estimate_from == (1, 3)
    excluded = campaign.state().maneuvers[1]
    assert excluded.excluded_because == "the pilot held the wheel"
    assert excluded.verdict.sentence == "EXCLUDED by hand: the pilot held the wheel"
    campaign.exclude(2, None)
    assert campaign.state().estimate_from == (1, 2, 3)


def test_an_exclusion_in_the_file_of_decisions_counts_for_roll_and_yaw(joint: list[int]) -> None:
    start_s = judged(2, "aileron").maneuver.span.start_s
    by_hand = ByHand(excluded=(Remark(start_s, "gust"),), notes=(Remark(start_s, "rough air"),))
    campaign = flown("rudder", "aileron", "aileron", by_hand=by_hand)
    assert campaign.state().estimate_from == (1, 3)
    assert campaign.judged[1].notes == ("rough air",)


def test_a_stop_ends_where_a_manoeuvre_on_which_it_rests_is_excluded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(axis_campaign, "estimate_axis", lambda *_: estimate("aileron", "rudder", percent=2.0))
    monkeypatch.setattr(axis_campaign, "judge", lambda *_: ())
    campaign = flown("rudder", "aileron")
    assert campaign.flight_test.decision == "stop"
    campaign.exclude(1, "gust")
    assert campaign.flight_test.decision == "continue"


def test_a_manoeuvre_that_contradicts_all_the_others_is_left_out_and_said(monkeypatch):
    sound = estimate("aileron", "rudder", percent=2.0)
    rng, std = np.random.default_rng(5), np.sqrt(np.diag(sound.covariance))
    theta = [sound.theta + std * rng.standard_normal(len(std)) for _ in range(6)]
    theta[3] = theta[3] * 1.4
    estimates = iter([replace(sound, theta=one) for one in theta])
    monkeypatch.setattr(axis_campaign, "estimate_axis", lambda *_: next(estimates, sound))
    monkeypatch.setattr(axis_campaign, "judge", lambda *_: ())
    monkeypatch.setattr(LateralCampaign, "_may_stop", False)
    campaign = flown(*["rudder", "aileron"] * 3)
    assert [one.maneuver.number for one in campaign.judged if not one.verdict.accepted] == [4]
    assert campaign.judged[3].verdict.reasons[0].code == "odd"
    assert campaign.state().estimate_from == (1, 2, 3, 5, 6)
