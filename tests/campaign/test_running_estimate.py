"""Numbers of the manoeuvre in the air are shown once they are numbers."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.campaign import Campaign
from advisor.campaign.running_estimate import Settling, agrees
from advisor.campaign.state import CampaignState
from advisor.mavlink.logs.logs import open_log
from advisor.session.timeline import Timeline
from tests.decision.campaigns import THETA, estimate, with_change
from tests.flights import TWO, recorded

M_ALPHA = PARAMETERS.index("M_alpha")
TRUTH = -4.93
"""M_α of the linear aircraft."""


@pytest.fixture(scope="module")
def states() -> list[CampaignState]:
    """States during two manoeuvres, about two a second."""
    return _during_two_manoeuvres(Aircraft(elevator=Elevator(lag_s=0.0)))


def _during_two_manoeuvres(aircraft: Aircraft) -> list[CampaignState]:
    campaign = Campaign(aircraft, settle=True)
    states: list[CampaignState] = []
    timeline = Timeline(
        [columns for batch in open_log(recorded("linear", 1.0, maneuvers=TWO)) for columns in batch]
    )
    for position_s in np.arange(0.0, timeline.duration_s, 0.5):
        campaign.feed(timeline.up_to(float(position_s)))
        state = campaign.state
        if state.flying is not None:
            states.append(state)
        if len(state.maneuvers) == 2:
            return states
    raise AssertionError("the flight has two manoeuvres")


def test_no_number_is_readable_before_the_input_is_over(states):
    assert not any(s.readable for s in states if not s.flying.span.input_is_over)


def test_nobody_is_told_to_recover_before_the_input_is_over(states):
    assert all(s.enough is None for s in states if not s.flying.span.input_is_over)


def test_no_readable_number_is_far_from_the_truth(states):
    readable = [s.settling for s in states if s.readable]
    assert len(readable) > 5
    assert all(abs(e.theta[M_ALPHA] - TRUTH) < 3.0 * e.std[M_ALPHA] for e in readable)


def test_progress_is_told_against_the_manoeuvres_before(states):
    first, last = states[0], states[-1]
    assert " of " not in first.progress
    assert last.progress.startswith("flown ")
    assert " s of " in last.progress


def test_an_estimate_far_from_the_joint_one_does_not_agree():
    assert agrees(estimate(THETA), estimate(THETA))
    assert not agrees(estimate(with_change("M_alpha", 1.1)), estimate(THETA))


def test_wide_intervals_agree_with_more():
    apart = with_change("M_alpha", 1.1)
    assert agrees(estimate(apart, std_percent=10.0), estimate(THETA))


def test_agreement_is_judged_at_one_air_speed():
    faster = THETA * np.array([1.1, 1.1, 1.0, 1.1, 1.21, 1.21, 1.1, 1.21])
    there = replace(estimate(faster), airspeed_m_s=33.0)
    assert agrees(there, replace(estimate(THETA), airspeed_m_s=30.0))
    assert not agrees(there, replace(estimate(THETA), airspeed_m_s=33.0))


@pytest.mark.parametrize(
    ("seconds", "gain", "is_enough"),
    [(0.4, 0.0, False), (0.5, 0.0, True), (0.5, 0.007, True), (0.5, 0.02, False)],
)
def test_free_response_is_enough_once_half_a_second_adds_less_than_a_percent(seconds, gain, is_enough):
    settling = Settling()
    settling._stds.extend([(10.0, np.ones(8)), (10.0 + seconds, np.full(8, 1.0 - gain))])
    assert (settling._enough(10.0 + seconds) is not None) == is_enough
