"""The lines of a campaign without a screen."""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from advisor.campaign.campaign import Campaign, ManeuverJudged
from advisor.decision.stopping import ENOUGH
from advisor.decision.verdict import FlightTestVerdict, NextInput, crew_plan
from advisor.flight.maneuvers.maneuver import DataAgain, NoData
from advisor.report import text as module
from advisor.report.text import follow
from advisor.words.problems import Problem

SLOW = NoData((Problem("rate", "ATTITUDE arrives at 4.0 Hz.", "Ask for 50 Hz."),))


class Told:
    """A campaign that gives one list of events for each batch; the data serve after ``DataAgain``."""

    def __init__(self, *events: Sequence[object], lateral: object = None) -> None:
        self._events = list(events)
        self.serves = False
        self.state = SimpleNamespace(failed=(), lateral=lateral)

    def feed(self, columns: object) -> Sequence[object]:
        events = self._events.pop(0)
        self.serves = not any(isinstance(event, NoData) for event in events)
        return events

    def finish(self) -> Sequence[object]:
        return ()


def lines(*events: Sequence[object], of_log: bool) -> list[str]:
    said: list[str] = []
    follow(iter([[] for _ in events]), cast(Any, Told(*events)), said.append, of_log)
    return said


def test_a_log_that_begins_with_slow_streams_gives_no_alarm() -> None:
    assert lines([SLOW], [DataAgain()], of_log=True) == []


@pytest.mark.parametrize("of_log", [True, False])
def test_data_that_fail_after_they_served_give_an_alarm(of_log: bool) -> None:
    said = lines([], [SLOW], [DataAgain()], of_log=of_log)
    assert [line.partition(":")[0] for line in said] == ["NO DATA", "DATA AGAIN"]


def test_a_link_that_begins_with_slow_streams_gives_an_alarm() -> None:
    assert lines([SLOW], of_log=False) == ["NO DATA: ATTITUDE arrives at 4.0 Hz. Ask for 50 Hz."]


def test_the_end_says_that_roll_and_yaw_could_not_be_followed() -> None:
    said: list[str] = []
    untold = SimpleNamespace(sentence="The output of aileron is not known.", next=None)
    side = SimpleNamespace(maneuvers=(), flight_test=untold)
    follow(iter([[]]), cast(Any, Told([], lateral=side)), said.append)
    assert said == ["note: The output of aileron is not known."]


def test_a_complete_axis_is_no_complete_test_while_the_other_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "maneuver_line", lambda _: "1  3-2-1-1")
    pitch = FlightTestVerdict("information", "stop", "TEST COMPLETE", 20.0, 100.0, 1, next=ENOUGH)
    open_ = replace(pitch, decision="continue", next=NextInput("next: aileron doublet", None))
    judged = ManeuverJudged(cast(Any, None), pitch, crew_plan(pitch, open_))
    assert lines([judged], of_log=True) == [
        "1  3-2-1-1",
        "    Pitch is complete, roll and yaw are open.",
        "    next: aileron doublet",
    ]


def test_the_campaign_type_has_what_follow_asks() -> None:
    assert isinstance(Campaign.serves, property)
