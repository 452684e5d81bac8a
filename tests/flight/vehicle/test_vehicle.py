"""Who the vehicle is among everything that sends heartbeats."""

from math import nan

import pytest

from advisor.flight.vehicle.modes import closes_pitch_loop, hovers, mode_name, stays
from advisor.flight.vehicle.vehicle import Vehicle, VehicleFinder, is_aircraft
from tests.flight.columns import Wire, heartbeat
from tests.rows import row

GCS, GIMBAL, ONBOARD, PLANE = 6, 26, 18, 1
INVALID, ARDUPILOT, PX4 = 8, 3, 12


def heard(*senders, target_system=None):
    finder = VehicleFinder(target_system)
    for at_s, sender in enumerate(senders):
        wire = Wire()
        heartbeat(wire, float(at_s), **sender)
        finder.hear(wire.columns()[0])
    return finder


def test_a_ground_station_or_gimbal_heard_first_is_not_the_vehicle():
    finder = heard(
        {"autopilot": INVALID, "kind": GCS, "system": 255, "component": 190},
        {"autopilot": INVALID, "kind": GIMBAL, "component": 154},
        {"autopilot": ARDUPILOT, "kind": ONBOARD, "component": 191},
        {"autopilot": ARDUPILOT, "kind": PLANE, "system": 7},
    )
    assert finder.vehicle == Vehicle(7, 1, "ardupilot", PLANE)
    assert finder.others == set()


@row("of several vehicles the first is followed and the others are known", None, 3, {5})
@row("the vehicle asked for is waited for", 5, 5, {3})
def test_one_of_several_vehicles_is_followed(asked, system, others):
    finder = heard({"system": 3}, {"system": 5}, {"system": 3}, target_system=asked)
    assert finder.vehicle is not None
    assert (finder.vehicle.system, finder.others) == (system, others)


def test_an_unknown_autopilot_is_named_by_its_number():
    finder = heard({"autopilot": 17})
    assert str(finder.vehicle) == "autopilot 17 1/1"


@pytest.mark.parametrize(
    ("autopilot", "custom", "name"),
    [("ardupilot", 0, "MANUAL"), ("ardupilot", 7, "CRUISE"), ("ardupilot", 99, "mode 99"),
     ("px4", 1 << 16, "Manual"), ("px4", 4 << 16 | 3 << 24, "Hold"), ("px4", 4 << 16 | 5 << 24, "Return"),
     ("px4", 7 << 16, "Stabilized"), ("px4", 4 << 16 | 99 << 24, "Auto"), ("generic", 4, "mode 4")],
)  # fmt: skip
def test_modes_bear_the_names_their_users_know(autopilot, custom, name):
    assert mode_name(autopilot, PLANE, custom) == name


def test_the_link_and_the_core_agree_on_what_an_aircraft_is():
    assert is_aircraft(ARDUPILOT, PLANE)
    assert is_aircraft(PX4, 22)
    assert not is_aircraft(INVALID, PLANE)
    assert not is_aircraft(ARDUPILOT, GCS)


def test_only_known_modes_other_than_manual_are_said_to_close_the_pitch_loop():
    assert closes_pitch_loop("CRUISE")
    assert closes_pitch_loop("Stabilized")
    assert not closes_pitch_loop("MANUAL")
    assert not closes_pitch_loop("Manual")
    assert not closes_pitch_loop("mode 77")
    assert not closes_pitch_loop("")


def test_a_copters_mode_zero_is_not_a_planes_manual():
    assert mode_name("ardupilot", 2, 0) == "STABILIZE"
    assert mode_name("ardupilot", PLANE, 0) == "MANUAL"


def test_a_quadplane_hovers_in_its_modes_of_the_rotors():
    assert all(hovers(mode) for mode in ("QHOVER", "QLOITER", "QSTABILIZE", "LOITER_ALT_QLAND"))
    assert not any(hovers(mode) for mode in ("MANUAL", "FBWA", "Manual", "AUTOLAND", ""))


CHANGES = ((nan, ""), (nan, "TAKEOFF"), (10.0, "FBWA"), (40.0, "MANUAL"))


def test_a_stay_lasts_until_the_next_mode_and_the_last_one_to_the_end():
    found = list(stays(CHANGES, 2.0, 60.0))
    assert found == [(2.0, 10.0, "TAKEOFF"), (10.0, 40.0, "FBWA"), (40.0, 60.0, "MANUAL")]


def test_a_stay_outside_the_two_times_is_left_out_or_cut():
    assert list(stays(CHANGES, 20.0, 30.0)) == [(20.0, 30.0, "FBWA")]
