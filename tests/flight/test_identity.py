"""What the vehicle's own parameters say, whoever sends them."""

from advisor.aircraft import Elevator
from advisor.flight.identity import Identity
from advisor.flight.surfaces import Surface
from tests.flight.columns import Wire, heartbeat, parameter

GROUND_STATION, GIMBAL = 190, 154


def elevator(*parameters):
    """Elevator after a heartbeat of 1/1 and PARAM_VALUEs given as (component, name, value)."""
    identity = Identity(Elevator(), None)
    wire = Wire()
    heartbeat(wire, 0.0)
    for at_s, (component, name, value) in enumerate(parameters, start=1):
        parameter(wire, float(at_s), name, value, component=component)
    for row in range(len(wire)):
        identity.learn(wire.columns([row]))
    return identity.elevator


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
