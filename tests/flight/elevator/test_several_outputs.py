"""Elevons, V-tails, split and mixed elevators give what a plain elevator gives on the same flight."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, ElevatorOutput
from advisor.flight.elevator.mixing import pitch_signs
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import Channel
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.pieces import rows_between
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate_jointly
from tests.flight.wiring import Pulse, flown, wired
from tests.flights import TWO, recorded

DOWN = ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
"""More pulse is trailing edge down, as in the log."""
UP = ((1100.0, 25.0), (1500.0, 0.0), (1900.0, -25.0))
HALF = ((1100.0, -12.5), (1900.0, 12.5))
NOTHING_TOLD = Aircraft()


def both(pitch, other):
    return pitch


def left(pitch, other):
    return pitch + other


def right(pitch, other):
    return pitch - other


def turned(pulse: Pulse) -> Pulse:
    return lambda pitch, other: -pulse(pitch, other)


def function(number: int, *, of: int, reversed_: int) -> dict[str, float]:
    return {f"SERVO{of}_REVERSED": float(reversed_), f"SERVO{of}_FUNCTION": float(number)}


def listed(*outputs: ElevatorOutput) -> Aircraft:
    return Aircraft(elevator=Elevator(outputs=outputs))


@dataclass(frozen=True)
class Kind:
    """A way to make an elevator."""

    outputs: dict[int, Pulse]
    aircraft: Aircraft = NOTHING_TOLD
    parameters: dict[str, float] = field(default_factory=dict)
    share: float = 1.0
    """Deflection of this elevator for one of the plain elevator's."""


PLAIN = Kind({2: both}, Aircraft(elevator=Elevator(output=2, calibration=DOWN)))
ELEVONS = {1: left, 2: turned(right)}
PAIR = {**function(77, of=1, reversed_=1), **function(78, of=2, reversed_=0)}
FUNCTIONS_ONLY = {name: value for name, value in PAIR.items() if name.endswith("FUNCTION")}
KINDS = {
    "elevons by their parameters": Kind(ELEVONS, NOTHING_TOLD, PAIR),
    "elevons by one calibration": Kind(ELEVONS, Aircraft(elevator=Elevator(calibration=DOWN)), PAIR),
    "elevons by a list": Kind(ELEVONS, listed(ElevatorOutput(1, DOWN), ElevatorOutput(2, UP))),
    "elevons by the aircraft's response": Kind(ELEVONS, listed(ElevatorOutput(1), ElevatorOutput(2))),
    "elevons whose REVERSED is not recorded": Kind(ELEVONS, NOTHING_TOLD, FUNCTIONS_ONLY),
    "V-tail": Kind(
        {2: turned(left), 4: turned(right)},
        NOTHING_TOLD,
        {**function(79, of=2, reversed_=0), **function(80, of=4, reversed_=0)},
    ),
    "two elevators, one of them reversed": Kind(
        {2: both, 5: turned(both)},
        NOTHING_TOLD,
        {**function(19, of=2, reversed_=1), **function(19, of=5, reversed_=0)},
    ),
    "two elevators of which nothing is told": Kind(
        {2: both, 5: turned(both)}, listed(ElevatorOutput(2), ElevatorOutput(5))
    ),
    "stabilator with a tab that moves half as far": Kind(
        {2: both, 6: both}, listed(ElevatorOutput(2, DOWN), ElevatorOutput(6, HALF, 0.3)), share=1.15 / 1.3
    ),
    "elevator with flaperons that come up with it": Kind(
        {2: both, 6: left, 7: turned(right)},
        listed(ElevatorOutput(2, DOWN), ElevatorOutput(6, DOWN, 0.2), ElevatorOutput(7, UP, 0.2)),
    ),
    "differential spoilers": Kind(
        {1: left, 2: right, 5: left, 6: right},
        NOTHING_TOLD,
        {
            name: value
            for number, of in ((16, 1), (17, 2), (86, 5), (87, 6))
            for name, value in function(number, of=of, reversed_=1).items()
        },
    ),
    "elevons in two banks": Kind(
        {2: left, 18: right}, listed(ElevatorOutput(2, DOWN), ElevatorOutput(18, DOWN))
    ),
}


def flight() -> Path:
    return recorded("linear", 1.0, maneuvers=TWO[:1])


def batches(made: Kind) -> Iterator[list[Columns]]:
    """A flight of one manoeuvre with this elevator."""
    return wired(made.outputs, made.parameters, flight())


@dataclass(frozen=True)
class Answer:
    """What is made of one flight."""

    stream: FlightStream
    maneuvers: list[Maneuver]
    estimate: Estimate
    notices: list[str]


@cache
def estimated(kind: str) -> Answer:
    made = KINDS.get(kind, PLAIN)
    stream, found, notices = flown(batches(made), made.aircraft)
    maneuvers = [event.maneuver for event in found]
    estimate = estimate_jointly(maneuvers, made.aircraft)
    assert isinstance(estimate, Estimate)
    return Answer(stream, maneuvers, estimate, [notice.code for notice in notices])


@pytest.mark.parametrize("kind", KINDS)
def test_the_derivatives_are_those_of_the_plain_elevator(kind: str) -> None:
    plain, mine = estimated("plain"), estimated(kind)
    effect = np.array([1.0, 1.0, 1.0, KINDS[kind].share, 1.0, 1.0, 1.0, KINDS[kind].share])
    assert len(mine.maneuvers) == len(plain.maneuvers) == 1
    away = np.abs(mine.estimate.theta * effect - plain.estimate.theta)
    assert np.all(away < 1.96 * plain.estimate.std)


@pytest.mark.parametrize("kind", KINDS)
def test_what_the_elevator_is_made_of_is_said(kind: str) -> None:
    answer = estimated(kind)
    assert "elevator_scale" in answer.notices
    said = answer.stream.elevator_notes[0]
    assert said.startswith("The elevator is ")
    assert all(str(n) in said for n in KINDS[kind].outputs)


def test_before_the_aircraft_has_answered_it_is_said_that_nothing_is_known() -> None:
    stream = FlightStream(listed(ElevatorOutput(1), ElevatorOutput(2)))
    stream.feed(rows_between(next(wired(ELEVONS, {}, flight())), 0, 20_000))
    assert "Nothing says which way outputs 1 and 2 move the nose" in stream.elevator_notes[1]


def test_what_the_aircraft_answered_is_said_once() -> None:
    answer = estimated("elevons by the aircraft's response")
    assert answer.notices.count("elevator_mixing") == 1
    assert "the sign of output 1 is turned" in answer.stream.elevator_notes[1]
    assert len(answer.stream.elevator_notes) == 2
    assert "elevator_backwards" not in answer.notices


@pytest.mark.parametrize("kind", ["elevons by the aircraft's response", "elevons in two banks"])
def test_live_and_replay_see_the_same_elevator(kind: str) -> None:
    made = KINDS[kind]
    stream = FlightStream(made.aircraft)
    events = []
    for batch in batches(made):
        past = max(int(c.order[-1]) for c in batch) + 1
        edges = np.linspace(0, past, 300).astype(int).tolist()
        for a, b in pairwise(edges):
            events += stream.feed(rows_between(batch, a, b))
    events += stream.finish()
    mine = [event.maneuver for event in events if isinstance(event, ManeuverFlown)]
    found = estimated(kind).maneuvers
    assert len(mine) == len(found) == 1
    for one, other in zip(mine, found, strict=True):
        assert one.span == other.span
        np.testing.assert_array_equal(one.channels["elevator"].y, other.channels["elevator"].y)


def test_signs_with_which_the_outputs_cancel_are_a_problem_that_names_them() -> None:
    aircraft = listed(ElevatorOutput(1, DOWN), ElevatorOutput(2, DOWN))
    stream, found, _ = flown(wired({1: both, 2: turned(both)}, {}, flight()), aircraft)
    assert not found
    problem, *_ = stream.problems()
    assert problem.code == "elevator_signs"
    assert "one way by output 2 and the other way by output 1" in problem.text
    assert "elevator.outputs" in problem.fix


def test_an_output_that_rests_tells_nothing_and_the_others_do() -> None:
    t = np.arange(0.0, 8.0, 0.02)
    pull = 0.05 * np.sign(np.sin(1.7 * t))
    q = Channel("q", t, np.cumsum(-7.0 * pull) * 0.02 + 1e-4 * np.sin(31.0 * t))
    angles = np.column_stack([pull, np.zeros(len(t)), -pull])
    assert pitch_signs(t, angles, (0.4, 0.2, 0.4), q, None) == [False, None, True]


def test_outputs_that_only_move_together_are_asked_one_by_one_where_nothing_is_told_of_them() -> None:
    t = np.arange(0.0, 8.0, 0.02)
    pull = 0.05 * np.sign(np.sin(1.7 * t))
    q = Channel("q", t, np.cumsum(-7.0 * pull) * 0.02 + 1e-4 * np.sin(31.0 * t))
    together = np.column_stack([pull, -0.3 * pull])
    assert pitch_signs(t, together, (0.7, 0.3), q, None, singly=True) == [False, True]
    assert None in pitch_signs(t, together, (0.7, 0.3), q, None)


def test_a_pitch_rate_that_follows_no_output_tells_nothing() -> None:
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 8.0, 0.02)
    q = Channel("q", t, 0.01 * rng.standard_normal(len(t)))
    angles = 0.05 * np.sign(np.sin(np.outer(t, [1.7, 2.3])))
    assert pitch_signs(t, angles, (0.5, 0.5), q, None) == [None, None]
