"""Which lateral manoeuvres the joint estimate of a flight holds, and when the crew pays for one."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign import lateral
from advisor.campaign.lateral import LateralCampaign
from advisor.process.parts import Parts
from tests.campaign.side_builders import estimate, judged


@pytest.fixture
def joint(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Number of manoeuvres of each joint estimate that is made; single ones are not counted."""
    made: list[int] = []

    def estimated(maneuvers, aircraft):
        if len(maneuvers) == 1:
            return estimate(maneuvers[0].span.kind.split()[0], percent=30.0)
        made.append(len(maneuvers))
        return estimate("aileron", "rudder", percent=30.0)

    monkeypatch.setattr(lateral, "estimate_lateral", estimated)
    monkeypatch.setattr(lateral, "judge_lateral", lambda maneuver, found, aircraft: ())
    return made


def flown(*controls: str) -> LateralCampaign:
    campaign = LateralCampaign(Aircraft(), Parts())
    for number, control in enumerate(controls, start=1):
        campaign.take(judged(number, control).maneuver)
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


def test_no_joint_estimate_is_made_before_both_controls_were_flown(joint: list[int]) -> None:
    flown("aileron", "aileron", "aileron")
    assert joint == []
    flown("aileron", "aileron", "rudder")
    assert joint == [3]
