"""A PX4 heard over telemetry: its elevator by its parameters, its modes, its hover."""

import struct

import pytest

from advisor.flight.maneuvers.maneuver import Activity, ManeuverFlown
from advisor.flight.vehicle.surfaces import Surface
from tests.flight.columns import Wire, attitude, heartbeat, hud, pull, servo
from tests.heard import hear

PX4 = 12
VTOL = 22
MANUAL = 1 << 16
PLANE = {
    "CA_SV_CS_COUNT": 2, "CA_SV_CS0_TYPE": 1, "CA_SV_CS1_TYPE": 3, "CA_SV_CS1_TRQ_P": 1.0,
    "PWM_MAIN_FUNC1": 201, "PWM_MAIN_FUNC5": 202, "PWM_MAIN_MIN5": 1000, "PWM_MAIN_MAX5": 2000,
}  # fmt: skip
INT32, REAL32 = 6, 9
HOVER, FORWARD = 3, 4


def stated(wire, at_s, name, value):
    """A PARAM_VALUE as PX4 sends it: the bytes of an integer in the field of a float."""
    is_whole = isinstance(value, int)
    carried = struct.unpack("<f", struct.pack("<i", value))[0] if is_whole else value
    wire.send(
        "PARAM_VALUE",
        at_s,
        param_id=name.encode(),
        param_value=carried,
        param_type=INT32 if is_whole else REAL32,
    )


def flight(parameters=PLANE, kind=1, mode=MANUAL, vtol_state=None, output=5, message="SERVO_OUTPUT_RAW"):
    wire = Wire()
    heartbeat(wire, 1000.0, mode=mode, autopilot=PX4, kind=kind)
    for k, (name, value) in enumerate(parameters.items()):
        stated(wire, 1000.001 + 1e-5 * k, name, value)
    if vtol_state is not None:
        wire.send("EXTENDED_SYS_STATE", 1000.005, vtol_state=vtol_state, landed_state=2)
    for k in range(700):
        since = k / 50
        now, boot = 1000.01 + since, 50.0 + since
        sense = pull(since - 4.0)
        attitude(wire, now, boot, q=0.2 * sense)
        if message == "SERVO_OUTPUT_RAW":
            servo(wire, now + 2e-4, boot, {1: 1500, output: 1500 + 20 * sense})
        else:
            pulses = [1500.0 + 20.0 * sense if n == output else 0.0 for n in range(1, 33)]
            wire.send(message, now + 2e-4, time_usec=round(boot * 1e6), active=31, actuator=pulses)
        hud(wire, now + 3e-4)
    return wire


def flown(wire):
    heard = hear([wire.columns()])
    return heard.stream, heard.events


@pytest.mark.parametrize("message", ["SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS"])
def test_the_elevator_is_found_by_integers_that_are_sent_as_their_bytes(message):
    stream, events = flown(flight(message=message))
    assert isinstance(stream.elevator, Surface)
    assert stream.elevator.outputs == (5,)
    (one,) = [event for event in events if isinstance(event, ManeuverFlown)]
    assert one.maneuver.mode == "Manual"


def test_integers_that_a_px4_sends_are_not_read_as_an_ardupilots():
    wire = flight()
    wire._sent = [(*m[:5], {**m[5], "autopilot": 3}) if m[2] == "HEARTBEAT" else m for m in wire._sent]
    assert not isinstance(flown(wire)[0].elevator, Surface)


def test_surfaces_beyond_the_count_are_not_in_use():
    stream, _ = flown(flight({**PLANE, "CA_SV_CS_COUNT": 1}))
    assert stream.problems()[0].code == "no_elevator"


def test_a_custom_surface_that_turns_in_pitch_alone_is_an_elevator():
    custom = {**PLANE, "CA_SV_CS1_TYPE": 12}
    assert flown(flight(custom))[0].elevator.outputs == (5,)
    assert not isinstance(flown(flight({**custom, "CA_SV_CS1_TRQ_R": 0.5}))[0].elevator, Surface)


def test_what_a_vtol_does_in_hover_is_no_test_input_and_in_forward_flight_it_is():
    _, hovering = flown(flight(kind=VTOL, vtol_state=HOVER))
    _, forward = flown(flight(kind=VTOL, vtol_state=FORWARD))
    assert [event.reason for event in hovering if isinstance(event, Activity)] == ["hover"]
    assert "Manual, hovering" in next(e.text for e in hovering if isinstance(e, Activity))
    assert [event for event in forward if isinstance(event, ManeuverFlown)]


def test_no_sentence_about_a_px4_speaks_of_ardupilots_parameters():
    stream, _ = flown(flight({}))
    said = " ".join(map(str, [*stream.problems(), *stream.elevator_notes]))
    assert "CA_SV_CSn_TYPE" in said
    assert "SERVOn" not in said
    assert "ArduP" not in said


@pytest.mark.parametrize("autopilot", [3, PX4])
def test_a_parameter_that_is_no_number_counts_as_unknown(autopilot):
    wire = flight({"CA_SV_CS0_TYPE": float("nan"), "SERVO2_FUNCTION": float("nan")})
    wire._sent = [
        (*m[:5], {**m[5], "autopilot": autopilot}) if m[2] == "HEARTBEAT" else m for m in wire._sent
    ]
    assert flown(wire)[0].problems()[0].code == "no_elevator"
