"""What is decided in the air is decided again from the recording, to the last bit."""

from copy import deepcopy
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import read_by_hand
from advisor.bundled.demo import Demonstration
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import NOTHING, ByHand, CampaignState
from advisor.flight.vehicle.pieces import rows_between
from advisor.mavlink.logs.logs import open_log
from advisor.oem.estimate import Estimate
from advisor.session.live import LinkSource
from tests.flights import TWO, recorded

pytestmark = pytest.mark.xdist_group("links")


def facts(state: CampaignState) -> list[object]:
    """Everything that was decided, with every number as it is."""
    told: list[object] = [state.flight_test, state.estimate_from, state.channels]
    for judged in state.maneuvers:
        assert isinstance(judged.estimate, Estimate)
        told += [judged.verdict, judged.maneuver.span, judged.estimate.cost]
        told += [judged.estimate.theta.tobytes(), judged.estimate.covariance.tobytes()]
    assert state.model is not None
    return [*told, state.model.theta.tobytes()]


def replayed(log: Path, by_hand: ByHand = NOTHING) -> Campaign:
    campaign = Campaign(Aircraft(), by_hand=by_hand)
    for batch in open_log(log):
        campaign.feed(batch)
    campaign.finish()
    return campaign


@pytest.fixture(scope="module")
def flown() -> Campaign:
    return replayed(recorded("linear", 1.0, maneuvers=TWO))


@pytest.fixture
def campaign(flown: Campaign) -> Campaign:
    """A campaign of two manoeuvres, to do with as one likes."""
    return deepcopy(flown)


@pytest.mark.study
def test_a_flight_followed_live_with_a_mark_and_its_recording_with_the_file_beside_it_give_one_result(
    tmp_path: Path,
) -> None:
    recording = tmp_path / "live.tlog"
    campaign = Campaign(Aircraft(), informs=True)
    flight = Demonstration("linear", 30.0, 5, recording)
    source, begun = LinkSource(flight, flight.over), False
    while (columns := source.read(0.05)) is not None:
        campaign.feed(columns)
        state = campaign.state
        if state.flying is not None and not begun:
            begun = True
            campaign.engineer.begin_maneuver()
        elif state.marking_since_s is not None and state.now_s > state.marking_since_s + 4.0:
            campaign.engineer.end_maneuver()
    campaign.finish()
    campaign.engineer.exclude(3, "a gust")
    assert "live.maneuvers.yaml" in source.keep(campaign.engineer.decided)
    source.close()
    closed_by = [judged.maneuver.span.closed_by for judged in campaign.state.maneuvers]
    assert closed_by[0] == "marked by hand"
    assert len(closed_by) == 7
    assert "marked by hand" not in closed_by[1:]
    again = replayed(recording, read_by_hand(recording)).state
    assert again.maneuvers[2].excluded_because == "a gust"
    assert facts(again) == facts(campaign.state)


def test_it_does_not_matter_how_the_stream_is_cut_into_batches() -> None:
    log = recorded("linear", 1.0, maneuvers=TWO[:1])
    columns = [piece for batch in open_log(log) for piece in batch]
    campaign = Campaign(Aircraft())
    past = max(int(piece.order[-1]) for piece in columns) + 1
    cuts = np.random.default_rng(3).choice(past, 300, replace=False)
    for first, after in pairwise([0, *sorted(cuts), past]):
        campaign.feed(rows_between(columns, first, after))
    campaign.finish()
    assert len(campaign.state.maneuvers) == 1
    assert facts(campaign.state) == facts(replayed(log).state)


def test_taking_a_manoeuvre_out_by_hand_decides_everything_again_and_putting_it_back_restores_it(campaign):
    before = facts(campaign.state)
    campaign.engineer.exclude(2, "a gust")
    state = campaign.state
    assert 2 not in state.estimate_from
    assert state.maneuvers[1].excluded_because == "a gust"
    assert not state.maneuvers[1].verdict.accepted
    assert state.flight_test.stopped_at != 2
    assert state.model is not None
    assert np.any(np.frombuffer(before[-1]) != state.model.theta)  # type: ignore[call-overload]
    campaign.engineer.include(2)
    assert facts(campaign.state) == before


def test_notes_and_marks_are_kept(campaign: Campaign) -> None:
    campaign.engineer.note(2, "rough hands")
    campaign.engineer.mark("turning back")
    assert campaign.state.maneuvers[1].notes == ("rough hands",)
    assert "turning back" in campaign.state.notices[-1]
