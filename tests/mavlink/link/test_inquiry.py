import struct
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.inquiry import Inquiry
from advisor.mavlink.wire.framing import FrameCutter
from tests.mavlink.link.builders import Sender

VEHICLE = (1, 1)
CRC_EXTRA = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}
PLANE = {
    **{f"SERVO{n}_FUNCTION": 0.0 for n in range(1, 17)},
    "SERVO2_FUNCTION": 19.0,
    "SERVO2_MIN": 1100.0,
    "SERVO2_TRIM": 1490.0,
    "SERVO2_MAX": 1900.0,
    "SERVO2_REVERSED": 1.0,
}


def encoded(value: float) -> tuple[float, int]:
    """A value as PARAM_VALUE carries it, and its type: the bytes of an integer, as PX4 sends them."""
    if isinstance(value, int):
        return struct.unpack("<f", struct.pack("<i", value))[0], dialect.MAV_PARAM_TYPE_INT32
    return value, dialect.MAV_PARAM_TYPE_REAL32


def converse(inquiry: Inquiry, has: dict[str, float], deaf_to: int = 0) -> list[Any]:
    """Answer every question the parameters of ``has`` can answer; the first ``deaf_to`` are lost."""
    sender, asked = Sender(), []
    now_s = 0.0
    for _ in range(200):
        for question in inquiry.speak(VEHICLE, now_s):
            asked.append(question)
            name = getattr(question, "param_id", b"")
            name = name.decode() if isinstance(name, bytes) else name
            if len(asked) > deaf_to and name in has:
                value = dialect.MAVLink_param_value_message(name.encode(), *encoded(has[name]), 900, 65535)
                (frame,) = FrameCutter(CRC_EXTRA).feed(sender.pack(value))
                inquiry.hear(frame, now_s)
        now_s += 0.25
        if inquiry.done:
            break
    assert inquiry.done
    return asked


def test_a_px4_is_asked_for_its_surfaces_and_for_the_limits_of_the_outputs_that_carry_them() -> None:
    has = {
        "CA_SV_CS0_TYPE": 1, "CA_SV_CS1_TYPE": 3, "CA_SV_CS1_TRQ_P": 1.0,
        "PWM_MAIN_FUNC3": 101, "PWM_MAIN_FUNC5": 202, "PWM_MAIN_MIN5": 1100, "PWM_MAIN_MAX5": 1900,
    }  # fmt: skip
    inquiry = Inquiry()
    heartbeat = dialect.MAVLink_heartbeat_message(1, dialect.MAV_AUTOPILOT_PX4, 81, 1 << 16, 4, 3)
    (frame,) = FrameCutter(CRC_EXTRA).feed(Sender().pack(heartbeat))
    inquiry.hear(frame, 0.0)
    asked = {getattr(message, "param_id", b"") for message in converse(inquiry, has)}
    assert {name: inquiry.parameters[name] for name in has} == has
    assert not [name for name in asked if str(name).startswith("SERVO")]
    assert b"PWM_MAIN_MIN3" not in asked


def names(asked: list[Any]) -> list[str]:
    return [message.param_id for message in asked if message.get_type() == "PARAM_REQUEST_READ"]


def test_the_output_that_pitches_is_found_and_its_travel_asked_for() -> None:
    inquiry = Inquiry()
    asked = converse(inquiry, PLANE)
    assert {name: inquiry.parameters[name] for name in PLANE} == PLANE
    assert "SERVO3_MIN" not in {getattr(message, "param_id", "") for message in asked}


def test_both_spellings_of_renamed_parameters_are_asked_and_either_is_taken() -> None:
    old, new = {"SR0_EXTRA1": 4.0, "SYSID_MYGCS": 255.0}, {"MAV1_EXTRA1": 4.0, "MAV_GCS_SYSID": 255.0}
    for spelling in (old, new):
        inquiry = Inquiry()
        converse(inquiry, {**PLANE, **spelling})
        assert {name: inquiry.parameters[name] for name in spelling} == spelling
        assert not (old.keys() | new.keys()) - spelling.keys() & inquiry.parameters.keys()


def test_lost_questions_are_repeated_and_what_does_not_exist_is_given_up() -> None:
    inquiry = Inquiry()
    asked = [getattr(message, "param_id", "") for message in converse(inquiry, PLANE, deaf_to=9)]
    assert {name: inquiry.parameters[name] for name in PLANE} == PLANE
    assert asked.count("MAV1_EXTRA1") == 3
    assert inquiry.report() == [f"{len(PLANE)} parameters of the vehicle heard"]
    assert inquiry.report() == []


def test_the_limits_of_the_elevator_are_asked_for_until_they_are_heard() -> None:
    inquiry = Inquiry(outputs_only=True)
    silent = {name: value for name, value in PLANE.items() if name.endswith("_FUNCTION")}
    converse(inquiry, silent)
    later = [question for second in range(60) for question in inquiry.speak(VEHICLE, 60.0 + second)]
    assert {"SERVO2_MIN", "SERVO2_TRIM", "SERVO2_MAX", "SERVO2_REVERSED"} == set(names(later))
    assert len(later) == 4 * 6


def test_elevons_and_v_tails_are_asked_on_every_output_they_have() -> None:
    elevons = {"SERVO1_FUNCTION": 77.0, "SERVO4_FUNCTION": 78.0, "SERVO1_MIN": 1000.0, "SERVO4_MIN": 1010.0}
    inquiry = Inquiry()
    converse(inquiry, elevons)
    assert {"SERVO1_MIN", "SERVO4_MIN"} <= inquiry.parameters.keys()


def test_only_a_few_questions_stand_at_a_time_and_the_firmware_is_asked_once() -> None:
    inquiry = Inquiry()
    first = inquiry.speak(VEHICLE, 0.0)
    assert len(first) == 11  # ten parameters, and the firmware
    firmware = [message for message in first if message.get_type() == "COMMAND_LONG"]
    assert [(message.command, message.param1) for message in firmware] == [(512, 148)]
    assert inquiry.speak(VEHICLE, 0.1) == []
    assert inquiry.speak(None, 9.0) == []
