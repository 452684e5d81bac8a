"""Why a stream cannot be used: every refusal names what is wrong and how to mend it."""

import math

import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, attitude, fly, heartbeat, hud, servo
from tests.rows import row


def problems(wire, aircraft=None, **options):
    stream = FlightStream(aircraft or Aircraft(), **options)
    stream.feed(wire.columns())
    stream.finish()
    return stream.problems()


def codes(wire, aircraft=None, **options):
    return [problem.code for problem in problems(wire, aircraft, **options)]


def flight(onsets=(4.0,), rate_hz=50.0, without=(), **sender):
    wire = Wire()
    fly(wire, 1000.0, 50.0, list(onsets), 14.0, rate_hz, **sender)
    wire._sent = [message for message in wire._sent if message[2] not in without]
    return wire


NO_CLOCK = ("ATTITUDE", "AOA_SSA", "SERVO_OUTPUT_RAW")


@row("a flight with a manoeuvre has no problem", (), [])
@row("without attitude there is no clock and only that is said", ("ATTITUDE",), ["no_pitch_rate"])
@row("without attitude other messages are missed too", NO_CLOCK, ["no_pitch_rate", "no_elevator", "no_alpha"])
@row("an angle of attack that can be derived is not missing", ("AOA_SSA",), [])
@row("an angle of attack that cannot be derived is missing", ("AOA_SSA", "VFR_HUD"), ["no_alpha"])
def test_a_flight_without_messages_has_these_problems(without, found):
    assert codes(flight(without=without)) == found


def test_a_ground_station_alone_is_no_vehicle():
    wire = Wire()
    heartbeat(wire, 1.0, autopilot=8, kind=6, system=255)
    assert codes(wire) == ["no_vehicle"]
    assert codes(Wire()) == ["no_vehicle"]


def test_a_target_system_that_is_not_there_is_told_who_is():
    (problem,) = problems(flight(system=3), target_system=5)
    assert problem.code == "no_vehicle"
    assert "--target-system 3" in problem.fix


def test_a_useless_vehicle_heard_first_names_the_other():
    wire = flight(system=3)
    heartbeat(wire, 999.0, system=5)
    found = problems(wire)
    assert found[0].code == "other_vehicles"
    assert "--target-system 3" in found[0].fix


def test_a_multicopter_is_told_that_it_has_no_elevator_and_nothing_else():
    wire = Wire()
    heartbeat(wire, 1000.0, kind=2)
    (problem,) = problems(wire)
    assert problem.code == "multicopter"
    assert "is a multicopter: it has no elevator" in problem.text
    assert "SERVO" not in str(problem)


@pytest.mark.parametrize("aircraft", [Aircraft(), Aircraft(elevator=Elevator(output=2))])
def test_a_multicopter_flies_no_manoeuvre_whatever_parameters_and_aircraft_file_say(aircraft):
    wire = flight()
    heartbeat(wire, 999.0, kind=2)
    (problem,) = problems(wire, aircraft)
    assert problem.code == "multicopter"


def test_a_missing_elevator_is_told_apart_from_one_that_is_not_sent():
    nowhere = problems(flight(without=("PARAM_VALUE",)))
    silent = problems(flight(without=("SERVO_OUTPUT_RAW",)))
    assert [p.code for p in nowhere] == [p.code for p in silent] == ["no_elevator"]
    assert "elevator.output" in nowhere[0].fix
    assert "never carried a pulse" in silent[0].text


def test_an_output_without_a_pulse_asks_for_the_safety_switch_and_not_for_its_message():
    wire = flight()
    wire._sent = [
        (*sent[:5], {k: 0 if k.endswith("_raw") else v for k, v in sent[5].items()})
        if sent[2] == "SERVO_OUTPUT_RAW"
        else sent
        for sent in wire._sent
    ]
    (problem,) = problems(wire)
    assert problem.code == "no_elevator"
    assert problem.text.endswith("arrives, but output 2, the elevator, carries no pulse: it is 0 throughout.")
    assert problem.fix.startswith("Release the safety switch and arm the vehicle")


def test_a_flight_without_test_inputs_says_what_to_fly():
    (problem,) = problems(flight(onsets=()))
    assert problem.code == "no_maneuver"
    assert "3-2-1-1" in problem.fix


def test_inputs_flown_in_a_mode_that_moves_the_elevator_itself_are_counted_and_the_mode_is_named():
    # A pulse, which any autopilot makes, too.
    wire = flight(onsets=(), mode=7)
    wire._sent = [
        (*m[:5], {**m[5], "servo2_raw": 1530 if 1004.0 <= m[0] < 1004.5 else 1500})
        if m[2] == "SERVO_OUTPUT_RAW" else m
        for m in wire._sent
    ]  # fmt: skip
    (problem,) = problems(wire)
    assert problem.code == "no_maneuver"
    assert "moved in CRUISE" in problem.text
    assert "MANUAL" in problem.fix


def test_slow_streams_are_named_with_their_rate_and_the_parameter_to_set():
    found = problems(flight(rate_hz=4.0))
    assert {p.code for p in found} == {"rate"}
    by_message = {p.text.split()[0]: p for p in found}
    assert set(by_message) == {"SERVO_OUTPUT_RAW", "ATTITUDE", "AOA_SSA"}
    assert "4.0 Hz" in by_message["ATTITUDE"].text
    for spelling in ("SR0_RC_CHAN", "MAV1_RC_CHAN", "--request-rates"):
        assert spelling in by_message["SERVO_OUTPUT_RAW"].fix


def test_ten_hertz_is_left_to_the_estimate_to_judge():
    assert "rate" not in codes(flight(rate_hz=10.0))


def test_ardupilot_parameters_are_not_recommended_to_others():
    wire = Wire()
    heartbeat(wire, 1000.0, autopilot=12)
    for k in range(40):
        attitude(wire, 1000.0 + k / 4, 50.0 + k / 4)
        servo(wire, 1000.0 + k / 4, 50.0 + k / 4, {2: 1500 + k})
        hud(wire, 1000.0 + k / 4)
    found = problems(wire, Aircraft(elevator=Elevator(output=2)))
    assert {p.code for p in found} == {"rate"}
    assert not any("SR0_" in p.fix for p in found)


@pytest.mark.parametrize("rate_hz", [8.5, 25.0, 100.0])
def test_rates_that_suffice_are_not_complained_of(rate_hz):
    assert "rate" not in codes(flight(rate_hz=rate_hz))


def test_a_pitch_rate_that_stands_still_while_the_attitude_moves_is_named():
    wire = Wire()
    fly(wire, 1000.0, 50.0, [4.0], 14.0)
    for at_s, _, name, _, _, fields in wire._sent:
        if name == "ATTITUDE":
            fields.update(pitchspeed=0.0, pitch=0.1 * math.sin(at_s))
    (problem,) = problems(wire)
    assert problem.code == "frozen"
    assert "gyro" in problem.fix
