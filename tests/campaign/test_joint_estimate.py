"""The joint estimate: of the newest accepted manoeuvres during the flight, of all at its end."""

import weakref
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign import axis_campaign as elevator
from advisor.campaign import joint_estimate, single_maneuver
from advisor.campaign.campaign import Campaign
from advisor.campaign.joint_estimate import Together, may_learn
from advisor.campaign.single_maneuver import assess
from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.mavlink.logs.logs import open_log
from advisor.oem import instrument_fit
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate_jointly, fit_jointly
from advisor.oem.known_instruments import FoundInstruments, with_found
from tests.decision.campaigns import estimate
from tests.flights import FOUR, TWO, recorded

NEWEST = 7
"""Manoeuvres that one estimate shares: those of a whole campaign of the paper."""

KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))
LEARNT = with_found(Aircraft(), FoundInstruments((), np.empty(0), np.empty(0), np.eye(8), None))


def numbers(state: CampaignState) -> tuple[int, ...]:
    return tuple(judged.maneuver.number for judged in state.maneuvers if judged.verdict.accepted)


def joint(state: CampaignState) -> Estimate:
    wanted: list[Maneuver] = [
        judged.maneuver for judged in state.maneuvers if judged.maneuver.number in state.estimate_from
    ]
    found = estimate_jointly(wanted, KNOWN)
    assert isinstance(found, Estimate)
    return found


@pytest.fixture(scope="module")
def states() -> tuple[CampaignState, CampaignState]:
    """A campaign longer than the two newest that are estimated together here: before its end, and after."""
    campaign = Campaign(KNOWN)
    with pytest.MonkeyPatch.context() as patch:
        for module in (elevator, joint_estimate):
            patch.setattr(module, "NEWEST", 2)
        for batch in open_log(recorded("linear", 1.0, maneuvers=FOUR[:3])):
            campaign.feed(batch)
        before = campaign.state
        assert before.model is not None  # computed where it is read
        campaign.finish()
        return before, campaign.state


def test_during_the_flight_the_newest_accepted_manoeuvres_are_estimated_together(states):
    flying, _ = states
    assert flying.estimate_from == numbers(flying)[-2:] != numbers(flying)
    assert flying.model is not None
    np.testing.assert_array_equal(flying.model.theta, joint(flying).theta)


def test_at_the_end_all_accepted_manoeuvres_are_estimated_together(states):
    _, ended = states
    assert ended.estimate_from == numbers(ended)
    assert ended.model is not None
    np.testing.assert_array_equal(ended.model.theta, joint(ended).theta)


def test_a_joint_estimate_that_was_asked_for_is_kept(states: tuple[CampaignState, CampaignState]) -> None:
    maneuvers = [judged.maneuver for judged in states[1].maneuvers[:2]]
    together = Together(KNOWN)
    first = together.estimate(maneuvers)
    assert together.estimate(list(maneuvers)) is first
    assert together.estimate([replace(maneuvers[0]), maneuvers[1]]) is not first


def test_a_further_manoeuvre_continues_the_fit_of_the_earlier_ones_on_its_only_hill(states, monkeypatch):
    maneuvers = [judged.maneuver for judged in states[1].maneuvers[:2]]
    anew = estimate_jointly(maneuvers, Aircraft())
    monkeypatch.setattr(joint_estimate, "fit_jointly", fit_jointly)
    together = Together(Aircraft())
    together.estimate(maneuvers[:1])
    monkeypatch.delattr(instrument_fit, "_hills")
    continued = together.estimate(maneuvers)
    assert continued is not None
    assert isinstance(anew, Estimate)
    assert np.all(np.abs(continued.theta - anew.theta) <= 0.03 * anew.std_cr)


def test_the_estimate_for_the_lag_comes_only_where_the_manoeuvres_tell_a_lag_to_a_tenth(states):
    maneuvers = [judged.maneuver for judged in states[1].maneuvers[:2]]
    open_ = Together(Aircraft())
    assert open_.of_lag(maneuvers) is None
    found = open_.estimate(maneuvers)
    assert found is not None
    lag = found.instrument("servo_lag_s")
    assert lag is not None
    assert lag.std > 0.1 * lag.value


def test_without_manoeuvres_there_is_no_joint_estimate() -> None:
    assert Together(KNOWN).estimate([]) is None


def test_the_newest_manoeuvres_alone_do_not_change_what_is_learnt() -> None:
    assert may_learn(Aircraft(), all_of_them=False)
    assert may_learn(LEARNT, all_of_them=True)
    assert not may_learn(LEARNT, all_of_them=False)


def test_reading_the_state_again_seeks_no_other_joint_estimate() -> None:
    campaign = Campaign(KNOWN)
    for batch in open_log(recorded("linear", 1.0, maneuvers=TWO)):
        campaign.feed(batch)
    assert campaign.state.model is not None
    assert campaign.state.model is campaign.state.model


@dataclass
class Fits:
    """Stands for the joint fit: keeps the numbers of the manoeuvres asked for, and tells a lag or none."""

    tells_lag: bool
    asked: list[list[int]]

    def __call__(self, maneuvers: Sequence[Maneuver], _: Aircraft, _near: object) -> "Fits | NoEstimate":
        self.asked.append([maneuver.number for maneuver in maneuvers])
        return self if self.tells_lag else NoEstimate("singular", "Nothing is told.")

    def estimate(self) -> "Fits":
        return self


def asked_for_a_lag(tells_lag, count, one, monkeypatch):
    fits = Fits(tells_lag, [])
    monkeypatch.setattr(joint_estimate, "fit_jointly", fits)
    accepted, together = [replace(one, number=k + 1) for k in range(count)], Together(Aircraft())
    for k in range(count):
        together.of_lag_so_far(accepted[: k + 1])
    return fits.asked


@pytest.mark.parametrize("more", [0, 1])
def test_only_a_fit_of_as_few_manoeuvres_as_in_flight_outlasts_its_estimate(more, states, monkeypatch):
    class Made(SimpleNamespace):
        """A fit of which nothing but its end is asked; unlike its base class it can be watched."""

    fits: list[weakref.ref[Made]] = []

    def fitted(*_: object) -> Made:
        made = Made(tells_lag=False, estimate=lambda: None)
        fits.append(weakref.ref(made))
        return made

    monkeypatch.setattr(joint_estimate, "fit_jointly", fitted)
    together = Together(Aircraft())
    together.estimate([states[0].maneuvers[0].maneuver] * (NEWEST + more))
    assert (fits[0]() is None) is (more > 0)


def test_after_a_group_that_tells_no_lag_the_next_whole_group_is_asked(states, monkeypatch):
    asked = asked_for_a_lag(False, 2 * NEWEST + 1, states[0].maneuvers[0].maneuver, monkeypatch)
    first = [list(range(1, k + 1)) for k in range(1, NEWEST + 1)]
    assert asked == [*first, list(range(NEWEST + 1, 2 * NEWEST + 1))]


def test_after_a_group_that_tells_a_lag_every_manoeuvre_is_asked_with_its_forerunners(states, monkeypatch):
    asked = asked_for_a_lag(True, NEWEST + 2, states[0].maneuvers[0].maneuver, monkeypatch)
    assert asked[NEWEST:] == [list(range(2, NEWEST + 2)), list(range(3, NEWEST + 3))]


@pytest.mark.parametrize(
    ("found", "moved"),
    [
        (estimate(), False),
        (replace(estimate(), gust_rad=0.01), True),
        (NoEstimate("diverged", "The model runs away."), False),
    ],
    ids=["calm", "gusts", "no estimate"],
)
def test_the_air_moved_where_the_estimate_found_gusts(monkeypatch, found, moved):
    monkeypatch.setattr(single_maneuver, "estimate", lambda *_: found)
    monkeypatch.setattr(single_maneuver, "judge", lambda *_: ())
    monkeypatch.setattr(single_maneuver, "cautions_of", lambda *_: [])
    assert assess(None, Aircraft()).air_moved == moved
