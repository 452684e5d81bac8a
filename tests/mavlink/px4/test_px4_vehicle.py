"""Which vehicle a PX4 log says flew."""

import numpy as np
import pytest

from advisor.mavlink.px4.px4_vehicle import heartbeat
from tests.rows import row

FIXED_WING, QUADROTOR, VTOL = 1, 2, 20
"""MAV_TYPE of MAVLink."""
ROTORS, WING = 1, 2
"""vehicle_type of PX4's vehicle_status."""


def kind(parameters=None, **status):
    """Return MAV_TYPE of the heartbeats of a log with these fields of vehicle_status."""
    stamps = {"timestamp": np.array([10, 20]), "nav_state": np.zeros(2)}
    topics = {"vehicle_status": [{**stamps, **{name: np.array(y) for name, y in status.items()}}]}
    return heartbeat(topics, parameters or {}, 0).fields["type"]


@row("a vehicle on rotors is a multicopter", {"vehicle_type": [ROTORS, ROTORS]}, QUADROTOR)
@row("a VTOL on rotors is no multicopter", {"vehicle_type": [ROTORS, ROTORS], "is_vtol": [1, 1]}, FIXED_WING)
@row("a vehicle on its wing is no multicopter", {"vehicle_type": [WING, WING]}, FIXED_WING)
@row("a vehicle once carried by its wing is no multicopter", {"vehicle_type": [ROTORS, WING]}, FIXED_WING)
@row("the older word of rotors counts", {"is_rotary_wing": [1, 1]}, QUADROTOR)
@row("the older word of no rotors counts", {"is_rotary_wing": [0, 0]}, FIXED_WING)
def test_the_kind_of_a_vehicle_follows_from_its_status(status, found):
    assert kind(**status) == found


@pytest.mark.parametrize(("stated", "counts"), [(VTOL, True), (0, False), (256, False)])
def test_a_type_of_the_parameters_comes_before_the_status(stated, counts):
    assert kind({"MAV_TYPE": stated}, vehicle_type=[ROTORS, ROTORS]) == (VTOL if counts else QUADROTOR)


def test_without_a_status_the_vehicle_is_an_aeroplane():
    assert heartbeat({}, {}, 0).fields["type"] == FIXED_WING
