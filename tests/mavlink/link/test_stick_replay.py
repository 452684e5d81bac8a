"""Recorded sticks go to a simulation, in their own time, and to nothing else."""

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.stick_replay import StickReplay
from advisor.mavlink.wire.framing import FrameCutter
from tests.mavlink.link.builders import Sender

VEHICLE = (1, 1)
CRC_EXTRA = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}
T = np.array([0.0, 0.1, 0.2, 0.3])
PULSES = np.array([[1500, 1500, 1400, 1500], [1500, 1700, 1400, 1500], [1500, 1300, 1400, 1500], [1500] * 4])


def answered(replay: StickReplay, name: str, value: float) -> None:
    message = dialect.MAVLink_param_value_message(name.encode(), value, dialect.MAV_PARAM_TYPE_REAL32, 9, 1)
    (frame,) = FrameCutter(CRC_EXTRA).feed(Sender().pack(message))
    replay.hear(frame, 0.0)


def flown(replay: StickReplay, until_s: float = 2.0) -> list[tuple[float, list[int]]]:
    """Return the times and pitch pulses that are sent."""
    return [
        (float(now), message.chan2_raw)
        for now in np.arange(0.0, until_s, 0.01)
        for message in replay.speak(VEHICLE, float(now))
        if message.get_type() == "RC_CHANNELS_OVERRIDE"
    ]


def test_pulses_go_out_in_their_own_time_and_are_released_at_the_end():
    replay = StickReplay(T, PULSES)
    answered(replay, "SIM_SPEEDUP", 1.0)
    answered(replay, "SYSID_MYGCS", 252.0)
    sent = flown(replay)
    assert {pulse for t, pulse in sent if 0.11 < t < 0.19} == {1700}
    assert {pulse for t, pulse in sent if 0.21 < t < 0.29} == {1300}
    assert [pulse for t, pulse in sent if t > 0.31] == [0] * 10
    assert replay.done
    assert not replay.refused


def test_a_vehicle_that_is_no_simulation_gets_questions_and_nothing_else():
    replay = StickReplay(T, PULSES)
    answered(replay, "SERVO2_MIN", 1100.0)
    assert flown(replay, 7.0) == []
    assert replay.refused


def test_the_override_comes_from_the_vehicles_own_ground_station():
    replay = StickReplay(T, PULSES)
    assert replay.source((254, 190), VEHICLE) == (255, 190)
    answered(replay, "SYSID_MYGCS", 252.0)
    assert replay.source((254, 190), VEHICLE) == (252, 190)


def test_the_first_override_waits_for_the_stations_id_for_the_time_of_one_question():
    replay = StickReplay(T, PULSES)
    answered(replay, "SIM_SPEEDUP", 1.0)
    assert flown(replay)[0][0] == pytest.approx(0.5, abs=0.011)
