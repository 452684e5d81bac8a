"""Where nothing says which output is the elevator, the one that the pitch rate answers to is guessed."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.log_facts import facts_of
from advisor.aircraft_file.proposal import proposed
from advisor.flight.maneuvers.maneuver import ManeuverFlown, Notice
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.following import TAKE
from tests.flight.columns import Wire, aoa, attitude, heartbeat, hud, parameter, pull, servo, text

START_S = 1000.0


def passive_flight(elevator=4, taken_at_s=None, until_s=60.0, answers=True, seed=1):
    """3-2-1-1 inputs every 15 s on one output, noise on the others, no parameter."""
    wire, dice, alpha, q = Wire(), np.random.default_rng(seed), 0.0, 0.0
    heartbeat(wire, START_S)
    for k in range(int(until_s * 50)):
        t = k / 50
        sense = pull(t % 15.0 - 4.0)
        pulses = {n: 1500 + round(20 * dice.standard_normal()) for n in range(1, 6)}
        pulses[elevator] = 1500 + 40 * sense
        attitude(wire, START_S + t, 50.0 + t, q=q + 0.001 * dice.standard_normal())
        aoa(wire, START_S + t + 1e-4, 50.0 + t, 2.0 + np.degrees(alpha))
        servo(wire, START_S + t + 2e-4, 50.0 + t, pulses)
        hud(wire, START_S + t + 3e-4)
        moment = -6.0 * alpha - 2.0 * q + 2.0 * sense * answers
        alpha, q = alpha + 0.02 * (q - 1.5 * alpha), q + 0.02 * moment
        if taken_at_s is not None and abs(t - taken_at_s) < 1e-9:
            text(wire, START_S + t + 4e-4, TAKE.decode() + str(elevator), system=254, component=190)
    return wire


def run(wire, size=None):
    stream = FlightStream(Aircraft())
    size = size or len(wire)
    events = []
    for i in range(0, len(wire), size):
        events += stream.feed(wire.columns(range(i, min(i + size, len(wire)))))
    return stream, [*events, *stream.finish()]


@pytest.mark.parametrize("output", [2, 4])
def test_the_output_that_the_pitch_rate_answers_to_is_guessed_and_said_with_how_sure(output):
    stream, events = run(passive_flight(output))
    (said,) = [e.text for e in events if isinstance(e, Notice) and e.code == "elevator_guess"]
    assert f"output {output} is a guess: it explains" in said
    (problem,) = [p for p in stream.problems() if p.code == "no_elevator"]
    assert f"output {output} is a guess" in problem.fix


def test_a_guess_decides_nothing_until_a_hand_takes_it():
    _, events = run(passive_flight())
    assert not any(isinstance(e, ManeuverFlown) for e in events)


def test_a_guess_that_a_hand_took_serves_from_there_on_and_the_stream_keeps_it():
    stream, events = run(passive_flight(taken_at_s=25.0))
    assert sum(isinstance(e, ManeuverFlown) for e in events) >= 2
    assert "by a guess that the crew has accepted" in stream.elevator_notes[0]


def test_parameters_that_come_later_outweigh_the_guess():
    wire = passive_flight(taken_at_s=25.0)
    parameter(wire, START_S + 40.0, "SERVO2_FUNCTION", 19.0)
    stream, _ = run(wire)
    assert stream.elevator.outputs == (2,)


def test_where_the_pitch_rate_answers_to_nothing_nothing_is_guessed():
    stream, _ = run(passive_flight(answers=False))
    assert stream.guess is None


@pytest.mark.parametrize("size", [23, 313])
def test_a_link_and_a_log_guess_the_same(size):
    wire = passive_flight(until_s=35.0)
    whole = run(wire)[0].guess
    assert whole is not None
    assert run(wire, size)[0].guess == whole


def test_an_output_that_a_hand_took_before_any_vehicle_was_heard_is_not_taken():
    early, flight = Wire(), passive_flight()
    text(early, START_S - 1.0, TAKE.decode() + "2", system=254, component=190)
    stream = FlightStream(Aircraft())
    assert stream.feed(early.columns(range(len(early)))) == []
    events = [*stream.feed(flight.columns(range(len(flight)))), *stream.finish()]
    assert not any(isinstance(e, ManeuverFlown) for e in events)


def side_flight():
    """Doublets of outputs 1 and 4 in turn, which roll and yaw the aircraft; no parameter."""
    wire, dice, p, r = Wire(), np.random.default_rng(5), 0.0, 0.0
    heartbeat(wire, START_S)
    for k in range(60 * 50):
        t = k / 50
        pulses = {n: 1500 + round(20 * dice.standard_normal()) for n in (2, 3)}
        rolls, yaws = pull(t % 20.0 - 4.0), pull(t % 20.0 - 14.0)
        p, r = p + 0.02 * (3.0 * rolls - 4.0 * p), r + 0.02 * (1.0 * yaws - 1.0 * r)
        wire.send(
            "ATTITUDE", START_S + t, time_boot_ms=round((50.0 + t) * 1000), roll=0.0, pitch=0.05, yaw=0.0,
            rollspeed=p + 0.001 * dice.standard_normal(), pitchspeed=0.001 * dice.standard_normal(),
            yawspeed=r + 0.001 * dice.standard_normal(),
        )  # fmt: skip
        servo(wire, START_S + t + 2e-4, 50.0 + t, {**pulses, 1: 1500 + 40 * rolls, 4: 1500 + 40 * yaws})
        hud(wire, START_S + t + 3e-4)
    return wire


def test_aileron_and_rudder_are_guessed_from_roll_rate_and_yaw_rate_for_a_new_file():
    facts = facts_of([side_flight().columns()], Aircraft())
    assert {name: guess.output for name, guess in facts.side_guesses.items()} == {"aileron": 1, "rudder": 4}
    assert "of what moves the roll rate" in str(facts.side_guesses["aileron"])
    draft = proposed(facts, "a.tlog")
    assert (draft.values["aileron.output"], draft.values["rudder.output"]) == (1, 4)
    assert any(said.startswith("Check rudder.output: output 4 is a guess") for said in draft.unsure)
