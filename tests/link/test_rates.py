from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.framing import FrameCutter
from advisor.mavlink.link import Link
from advisor.mavlink.rates import ANSWER_WITHIN_S, ASK_AGAIN_AFTER_S, MEASURE_S, MOST_TRIES, RateRequest
from tests.link.builders import Sender, UdpVehicle, attitude, free_port, heartbeat, wait_until

VEHICLE = (1, 1)
SET_INTERVAL = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
CRC_EXTRA = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}


def hear(request: RateRequest, message: Any, now_s: float) -> None:
    (frame,) = FrameCutter(CRC_EXTRA).feed(Sender().pack(message))
    request.hear(frame, now_s)


def answer(request: RateRequest, result: int, now_s: float, command: int = SET_INTERVAL) -> None:
    hear(request, dialect.MAVLink_command_ack_message(command, result), now_s)


def test_nothing_is_asked_before_a_vehicle_is_heard() -> None:
    assert RateRequest({"ATTITUDE": 50.0}).speak(None, 0.0) == []


def test_rates_are_asked_one_at_a_time_each_after_the_answer_to_the_last() -> None:
    request = RateRequest({"ATTITUDE": 50.0, "AOA_SSA": 20.0})
    (first,) = request.speak(VEHICLE, 0.0)
    assert (first.command, first.param1, first.param2) == (SET_INTERVAL, 30, 20_000.0)
    assert (first.target_system, first.target_component) == VEHICLE
    assert request.speak(VEHICLE, 0.1) == []
    answer(request, dialect.MAV_RESULT_ACCEPTED, 0.2)
    (second,) = request.speak(VEHICLE, 0.2)
    assert (second.param1, second.param2) == (11020, 50_000.0)
    answer(request, dialect.MAV_RESULT_UNSUPPORTED, 0.3)
    assert request.speak(VEHICLE, 0.3) == []
    assert request.answers == {"ATTITUDE": "granted", "AOA_SSA": "unsupported"}
    assert request.report() == ["AOA_SSA: the vehicle answers 'unsupported' to the request for its rate"]


def test_an_unanswered_request_is_repeated_with_its_confirmation_counted_up_then_given_up() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    sent = [request.speak(VEHICLE, i * ANSWER_WITHIN_S) for i in range(MOST_TRIES)]
    assert [message.confirmation for (message,) in sent] == list(range(MOST_TRIES))
    assert request.speak(VEHICLE, MOST_TRIES * ANSWER_WITHIN_S) == []
    assert request.answers == {"ATTITUDE": "no answer"}
    (sentence,) = request.report()
    assert "SYSID_MYGCS (MAV_GCS_SYSID)" in sentence


def test_answers_to_other_commands_and_in_progress_settle_nothing() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    answer(request, dialect.MAV_RESULT_ACCEPTED, 0.1, command=400)
    answer(request, dialect.MAV_RESULT_IN_PROGRESS, 0.1)
    assert request.answers == {}


def test_what_is_delivered_is_measured_not_believed() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    answer(request, dialect.MAV_RESULT_ACCEPTED, 0.1)
    request.speak(VEHICLE, 0.1)
    for i in range(75):
        hear(request, attitude(i), 0.1 + i * MEASURE_S / 75)
    request.speak(VEHICLE, 0.1 + MEASURE_S)
    assert request.delivered_hz == {"ATTITUDE": 25.0}
    assert request.report() == ["delivered: ATTITUDE 25.0 Hz of 50 asked"]


def test_a_rate_taken_away_in_flight_is_told_and_asked_for_again_at_most_once_a_minute() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    answer(request, dialect.MAV_RESULT_ACCEPTED, 0.0)
    asked_at = []
    for tick in range(3 * int(ASK_AGAIN_AFTER_S) * 50):
        now_s = tick / 50
        if tick % 12 == 0 or now_s < 20:  # after 20 s somebody cuts 50 Hz to 4 Hz
            hear(request, attitude(tick), now_s)
        for message in request.speak(VEHICLE, now_s):
            asked_at.append(now_s)
            assert message.param1 == 30
            answer(request, dialect.MAV_RESULT_ACCEPTED, now_s)
    told = request.report()
    assert len(asked_at) == 2
    assert ASK_AGAIN_AFTER_S <= asked_at[0] < ASK_AGAIN_AFTER_S + 2 * MEASURE_S
    assert asked_at[1] - asked_at[0] >= ASK_AGAIN_AFTER_S
    assert sum("asked for again: ATTITUDE 4." in sentence for sentence in told) >= 1


def test_over_a_link_the_request_reaches_the_vehicle_and_its_answer_comes_back() -> None:
    port = free_port()
    vehicle = UdpVehicle(port)
    request = RateRequest({"ATTITUDE": 50.0})
    with Link(f"udpin:127.0.0.1:{port}", talkers=[request]) as link:
        vehicle.send(heartbeat())
        command = vehicle.hear()
        assert command.get_type() == "COMMAND_LONG"
        assert (command.get_srcSystem(), command.target_system) == (254, 1)
        intruder = UdpVehicle(port, system=7)
        intruder.send(dialect.MAVLink_command_ack_message(SET_INTERVAL, dialect.MAV_RESULT_DENIED))
        link.read(0.2)
        assert request.answers == {}
        vehicle.send(dialect.MAVLink_command_ack_message(SET_INTERVAL, dialect.MAV_RESULT_ACCEPTED))
        wait_until(lambda: request.answers == {"ATTITUDE": "granted"})
        intruder.close()
    vehicle.close()
