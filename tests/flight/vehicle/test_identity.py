"""What the vehicle's own parameters say, whoever sends them."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import READER_NOTICE
from advisor.flight.stream.identity import Identity
from advisor.flight.vehicle.surfaces import Surface
from tests.flight.columns import Wire, heartbeat, parameter

GROUND_STATION, GIMBAL = 190, 154


def elevator(*parameters):
    """Elevator after a heartbeat of 1/1 and PARAM_VALUEs given as (component, name, value)."""
    identity = Identity(Aircraft(), None)
    wire = Wire()
    heartbeat(wire, 0.0)
    for at_s, (component, name, value) in enumerate(parameters, start=1):
        parameter(wire, float(at_s), name, value, component=component)
    for row in range(len(wire)):
        identity.learn(wire.columns([row]))
    return identity.outputs.elevator


def test_parameters_stored_by_the_ground_station_for_the_vehicle_count():
    found = elevator((GROUND_STATION, "SERVO2_FUNCTION", 19.0))
    assert isinstance(found, Surface)
    assert found.outputs == (2,)


def test_the_vehicles_own_word_outweighs_what_the_ground_station_stored():
    own, stored = (1, "SERVO2_TRIM", 1480.0), (GROUND_STATION, "SERVO2_TRIM", 1500.0)
    function = (1, "SERVO2_FUNCTION", 19.0)
    assert elevator(function, own, stored) == elevator(function, own)
    assert elevator(function, own) != elevator(function, stored)


def test_parameters_of_another_component_of_the_system_do_not_count():
    assert not isinstance(elevator((GIMBAL, "SERVO2_FUNCTION", 19.0)), Surface)


BEFORE = ((1, "SERVO2_FUNCTION", 19.0), (1, "SERVO2_TRIM", 1500.0), (1, "SERVO2_REVERSED", 0.0))


def after_a_change(name, value, flown):
    """The elevator after one of its parameters changes, and what is said of that."""
    identity, wire = Identity(Aircraft(), None), Wire()
    heartbeat(wire, 0.0)
    for at_s, (_, key, number) in enumerate((*BEFORE, (1, name, value)), start=1):
        parameter(wire, float(at_s), key, number)
    last = len(wire) - 1
    events = [identity.learn(wire.columns([row]), 10.0, flown and row == last) for row in range(last + 1)][-1]
    return identity.outputs.elevator, [e.text for e in events if getattr(e, "code", "") == READER_NOTICE]


@pytest.mark.parametrize(("name", "value"), [("SERVO2_TRIM", 1520.0), ("SERVO2_REVERSED", 1.0)])
def test_a_change_before_the_first_test_input_counts_from_its_moment_on_and_is_said(name, value):
    surface, told = after_a_change(name, value, flown=False)
    assert surface == elevator(*BEFORE, (1, name, value))
    assert told == [
        f"{name} changed from {1500 if 'TRIM' in name else 0} to {value:g} at 0:10.0: "
        f"the elevator is counted with {value:g} after that."
    ]


@pytest.mark.parametrize(("name", "value"), [("SERVO2_TRIM", 1520.0), ("SERVO2_REVERSED", 1.0)])
def test_a_change_after_a_test_input_moves_no_linkage_and_is_said(name, value):
    surface, told = after_a_change(name, value, flown=True)
    assert surface == elevator(*BEFORE)
    assert len(told) == 1
    assert "is still counted" in told[0]


def heard_late(*before, late):
    """The identity after a limit that arrives behind a test input, and the events of its arrival."""
    identity, wire = Identity(Aircraft(), None), Wire()
    heartbeat(wire, 0.0)
    for at_s, (name, value) in enumerate((*before, late), start=1):
        parameter(wire, float(at_s), name, value)
    events = [identity.learn(wire.columns([row]), 10.0, row == len(wire) - 1) for row in range(len(wire))]
    return identity, events[-1]


@pytest.mark.parametrize(
    "roles",
    [
        (("SERVO2_FUNCTION", 19.0),),
        (("SERVO1_FUNCTION", 77.0), ("SERVO2_FUNCTION", 78.0)),
        (("SERVO1_FUNCTION", 19.0), ("SERVO2_FUNCTION", 19.0)),
    ],
)
def test_a_limit_that_is_heard_late_waits_for_the_next_power_on_and_is_said(roles):
    identity, (notice,) = heard_late(*roles, late=("SERVO2_MIN", 1000.0))
    assert notice.text.startswith("SERVO2_MIN 1000 is heard only at 0:10.0: the value assumed before counts")
    assert identity.outputs.elevator == identity.outputs.counted["elevator"]
    assert identity.outputs.elevator.parts[-1].scale.low_us == 1100.0
    identity.outputs.begin()
    assert identity.outputs.counted["elevator"].parts[-1].scale.low_us == 1000.0


def test_a_direction_that_is_heard_late_waits_for_the_next_power_on():
    identity, (notice,) = heard_late(("SERVO2_FUNCTION", 19.0), late=("SERVO2_REVERSED", 1.0))
    assert "SERVO2_REVERSED 1 is heard only" in notice.text
    assert not identity.outputs.elevator.scale.reversed


def test_a_direction_that_is_heard_as_it_was_assumed_changes_nothing():
    identity, events = heard_late(("SERVO2_FUNCTION", 19.0), late=("SERVO2_REVERSED", 0.0))
    assert events == []
    assert identity.outputs.counted["elevator"].parts[0].sure


@pytest.mark.parametrize("flown", [False, True])
def test_a_limit_that_is_heard_as_it_was_assumed_changes_nothing(flown):
    assert after_a_change("SERVO2_MIN", 1100.0, flown)[1] == []


def test_every_assumed_limit_is_called_so_by_its_name():
    surface = elevator((1, "SERVO2_FUNCTION", 19.0), (1, "SERVO2_MIN", 1000.0))
    assert isinstance(surface, Surface)
    assert "is scaled by assumed limits" in surface.said
    assert "SERVO2_TRIM 1500 and SERVO2_MAX 1900 are assumed" in surface.said
    assert "SERVO2_MIN 1000" not in surface.said


@pytest.mark.parametrize(("name", "value"), [("SERVO2_TRIM", 1500.0), ("SERVO5_TRIM", 1400.0)])
def test_a_parameter_that_does_not_change_the_elevator_is_passed_over_in_silence(name, value):
    assert after_a_change(name, value, flown=True)[1] == []


@pytest.mark.parametrize(
    ("kind", "text", "expected"),
    [
        (255, "ArduPlane V4.5.6 (0123abcd)", "4.5.6"),
        (0, "ArduPlane V4.7.0-dev (0123abcd)", "4.7.0-dev"),
        (128, "ArduPlane V4.8.0-beta1 (0123abcd)", "4.8.0-beta1"),
        (192, "ArduPlane V4.6.0-rc2", "4.6.0-rc2"),
    ],
)
@pytest.mark.parametrize("text_first", [True, False])
def test_the_version_of_a_development_build_is_told_as_such(kind, text, expected, text_first):
    version = expected.partition("-")[0].split(".")
    packed = sum(int(part) << shift for part, shift in zip(version, (24, 16, 8), strict=True)) | kind
    identity, wire = Identity(Aircraft(), None), Wire()
    heartbeat(wire, 0.0)
    wire.send("AUTOPILOT_VERSION", 2.0, flight_sw_version=packed)
    wire.send("STATUSTEXT", 1.0 if text_first else 3.0, text=text.encode())
    for row in range(len(wire)):
        identity.learn(wire.columns([row]))
    assert identity.vehicle.firmware == expected
