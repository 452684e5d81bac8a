"""What a ground station hears of a flight on both axes: the word of the one plan that the screens show."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from advisor.campaign.campaign import ManeuverJudged
from advisor.cli.live import _announce, _tell
from advisor.decision.inputs import StepInput
from advisor.decision.verdict import FlightTestVerdict, NextInput, crew_plan
from advisor.mavlink.link.announce import Announcer
from tests.tui import flights

OPEN = FlightTestVerdict("information", "continue", "CONTINUE: much is open.", 300.0, 100.0, None)
COMPLETE = FlightTestVerdict("information", "stop", "TEST COMPLETE: all is known.", 20.0, 100.0, 1)


def heard(*flown: tuple[str, FlightTestVerdict, FlightTestVerdict | None]) -> list[str]:
    """Return the texts after manoeuvres, each with its axis and with both verdicts after it."""
    announcer, numbers, texts = Announcer(), {"pitch": 0, "lateral": 0}, []
    for axis, pitch, side in flown:
        numbers[axis] += 1
        judged = SimpleNamespace(
            maneuver=SimpleNamespace(number=numbers[axis]), verdict=SimpleNamespace(sentence="accepted")
        )
        plan = None if side is None else crew_plan(pitch, side)
        event = ManeuverJudged(judged, pitch if axis == "pitch" else side, plan, axis)
        _announce(announcer, event)
    while messages := announcer.speak((1, 1), 0.0):
        texts.append("".join(message.text for message in messages))
    return texts


def test_with_roll_and_yaw_open_pitch_alone_is_no_test_complete():
    assert heard(("pitch", OPEN, OPEN), ("pitch", COMPLETE, OPEN), ("lateral", COMPLETE, COMPLETE)) == [
        "@1 accepted",
        "@Pitch is complete, roll and yaw are open. (2 accepted)",
        "@TEST COMPLETE: Pitch is complete, roll and yaw are complete. (roll and yaw 1 accepted)",
    ]


def test_a_flight_of_pitch_alone_hears_its_verdict_once():
    assert heard(("pitch", COMPLETE, None), ("pitch", COMPLETE, None)) == [
        "@TEST COMPLETE: all is known. (1 accepted)",
        "@2 accepted",
    ]


def test_roll_and_yaw_that_begin_after_pitch_is_complete_are_heard_as_open():
    assert heard(("pitch", COMPLETE, None), ("lateral", COMPLETE, OPEN), ("lateral", COMPLETE, COMPLETE)) == [
        "@TEST COMPLETE: all is known. (1 accepted)",
        "@Pitch is complete, roll and yaw are open. (roll and yaw 1 accepted)",
        "@TEST COMPLETE: Pitch is complete, roll and yaw are complete. (roll and yaw 2 accepted)",
    ]


@pytest.mark.parametrize(("decision", "sent"), [("continue", 1), ("stop", 0)])
def test_an_input_is_sent_only_while_the_test_is_open(decision, sent):
    state = flights.state(3)
    advised = NextInput("next: 3-2-1-1", None, "M_q", StepInput("3211", 0.3, 0.05, True))
    test = replace(state.flight_test, decision=decision, next=advised)
    orders = []
    link = SimpleNamespace(advise=lambda *order: orders.append(order))
    _tell(link, False, True, ManeuverJudged(state.maneuvers[-1], test, None, "pitch", ()))
    assert len(orders) == sent
