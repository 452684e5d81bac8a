"""While a manoeuvre is flown, the state says how long it lasts and when its free response is recorded."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign import journal
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import AxisState, CampaignState
from advisor.mavlink.logs.logs import open_log
from advisor.session.timeline import Timeline
from tests.campaign import side_builders as side
from tests.decision.campaigns import THETA, estimate
from tests.flights import TWO, recorded


@pytest.fixture(scope="module")
def states() -> list[CampaignState]:
    """States during two manoeuvres, about two a second."""
    campaign = Campaign(Aircraft(elevator=Elevator(lag_s=0.0)))
    states: list[CampaignState] = []
    log = recorded("linear", 1.0, maneuvers=TWO)
    timeline = Timeline([columns for batch in open_log(log) for columns in batch])
    for position_s in np.arange(0.0, timeline.duration_s, 0.5):
        campaign.feed(timeline.up_to(float(position_s)))
        state = campaign.state
        if state.flying is not None:
            states.append(state)
        if len(state.maneuvers) == 2:
            return states
    raise AssertionError("the flight has two manoeuvres")


def test_progress_is_told_against_the_manoeuvres_before(states):
    first, last = states[0], states[-1]
    assert " of " not in first.progress
    assert last.progress.startswith("flown ")
    assert " s of " in last.progress


def test_a_manoeuvre_may_end_when_its_free_response_is_long_enough_to_be_judged(states):
    assert any(s.is_recorded for s in states)
    for state in states:
        span = state.flying.span
        assert state.is_recorded == (span.input_is_over and span.end_s - span.last_step_s >= 3.0)


def test_a_slow_aircraft_needs_a_longer_free_response(states):
    recorded_one = next(s for s in states if s.is_recorded)
    slow = estimate(THETA * np.array([0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1, 0.1]))
    axes = {"pitch": AxisState((), recorded_one.flight_test, slow)}
    assert not replace(recorded_one, axes=axes).is_recorded


def test_between_manoeuvres_nothing_is_recorded(states):
    assert not replace(states[-1], flying=None).is_recorded


def test_a_test_of_roll_and_yaw_does_not_wait_for_the_response_in_pitch(states):
    recorded_one = next(s for s in states if s.is_recorded)
    nothing = {"pitch": AxisState((), recorded_one.flight_test, None)}
    sideways = replace(recorded_one, axes={**nothing, "lateral": side.state(side.judged(1, "aileron"))})
    assert sideways.tested_sideways is not None
    assert not sideways.is_recorded


def test_an_event_log_forgets_the_oldest_sentences(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "KEPT", 3)
    log = journal.Journal()
    for k in range(5):
        log.write(str(k))
    assert [line.split()[-1] for line in log.lines] == ["2", "3", "4"]


def test_an_event_log_keeps_its_lines_until_something_is_added() -> None:
    log = journal.Journal()
    log.write("heard")
    lines = log.lines
    assert log.lines is lines
    log.write("heard again")
    assert log.lines is not lines
