"""Where no calibration says which way the elevator moves, the aircraft's answer does."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.analysis.gap_flights import maneuvers_of
from advisor.flight.elevator.elevator_guess import SAID, ElevatorSign, answers_backwards, turned
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.pieces import rows_between
from advisor.mavlink.logs.logs import open_log
from tests.flights import TWO, recorded
from tests.gap.generator import Setup, fly
from tests.heard import hear


def read(reversed_is=None):
    """Batches of a flight, as if SERVO2_REVERSED had been another."""
    batches = list(open_log(recorded("linear", 1.0, maneuvers=TWO)))
    for c in (c for batch in batches for c in batch if c.name == "PARAM_VALUE"):
        names = np.array([raw.rstrip(b"\0") for raw in c.fields["param_id"].tolist()])
        if reversed_is is not None:
            c.fields["param_value"][names == b"SERVO2_REVERSED"] = reversed_is
    return batches


def flown(aircraft, reversed_is=None):
    """The stream, its manoeuvres and the codes of its notices."""
    heard = hear(read(reversed_is), aircraft)
    return heard.stream, heard.maneuvers, [notice.code for notice in heard.notices]


def test_an_output_whose_sense_is_told_wrong_gives_the_same_manoeuvres_and_says_so():
    right, true, _ = flown(Aircraft())
    wrong, found, notices = flown(Aircraft(), reversed_is=0.0)
    assert [m.span for m in found] == [m.span for m in true]
    for mine, other in zip(found, true, strict=True):
        np.testing.assert_array_equal(mine.channels["elevator"].y, other.channels["elevator"].y)
    assert notices.count("elevator_backwards") == 1
    assert SAID in wrong.elevator_notes
    assert SAID not in right.elevator_notes


def test_what_is_being_flown_is_turned_as_soon_as_the_sense_is_known():
    seen = []
    for reversed_is in (1.0, 0.0):
        stream, (batch, *_) = FlightStream(Aircraft()), read(reversed_is)
        edges = np.linspace(0, max(int(c.order[-1]) for c in batch) + 1, 60).astype(int)
        parts = []
        for first, past in pairwise(edges.tolist()):
            stream.feed(rows_between(batch, first, past))
            if stream.maneuvers and (flying := stream.so_far()) is not None:
                parts.append(flying.channels["elevator"].y)
        seen.append(parts)
    assert len(seen[0]) == len(seen[1]) > 3
    for mine, other in zip(*seen, strict=True):
        np.testing.assert_array_equal(mine, other)


def test_a_calibration_is_believed_whatever_the_aircraft_does():
    backwards = ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
    forwards = tuple((pwm, -deg) for pwm, deg in backwards)
    found = [flown(Aircraft(elevator=Elevator(calibration=pairs)))[1] for pairs in (backwards, forwards)]
    np.testing.assert_array_equal(found[0][0].channels["elevator"].y, -found[1][0].channels["elevator"].y)


@pytest.mark.parametrize("setup", [Setup(maneuvers=3), Setup(maneuvers=3, gust_std=0.5, noise=0.05)])
def test_a_trailing_edge_that_goes_down_pitches_down(setup):
    for maneuver in fly(setup):
        assert answers_backwards(maneuver) is False
        assert answers_backwards(turned(maneuver)) is True
        assert turned(turned(maneuver)).span == maneuver.span


def test_a_manoeuvre_that_tells_nothing_decides_nothing():
    sense, rng = ElevatorSign(), np.random.default_rng(4)
    first, second = (turned(maneuver) for maneuver in fly(Setup(maneuvers=2)))
    q = first.channels["q"]
    still = replace(q, y=0.01 * rng.standard_normal(len(q.y)))
    told, notices = sense.right(replace(first, channels={**first.channels, "q": still}))
    assert (sense.backwards, notices) == (None, [])
    assert told.channels["elevator"] is first.channels["elevator"]
    right, notices = sense.right(second)
    assert len(notices) == 1
    assert right.span.steps == tuple((onset, -level) for onset, level in second.span.steps)


def test_a_diagnosis_knows_what_was_assumed_of_the_elevator():
    (note,) = maneuvers_of([recorded("linear", 1.0, maneuvers=TWO)], Aircraft()).notes
    assert "full travel of 25 deg" in note


def test_a_record_without_a_pitch_rate_tells_no_sign():
    _, (maneuver, *_), _ = flown(Aircraft())
    assert answers_backwards(maneuver) is not None
    channels = {name: one for name, one in maneuver.channels.items() if name != "q"}
    assert answers_backwards(replace(maneuver, channels=channels)) is None
