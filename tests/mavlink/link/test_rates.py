import contextlib
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.link import Link
from advisor.mavlink.link.link_watch import RateWatch
from advisor.mavlink.link.rates import RateRequest
from advisor.mavlink.wire.framing import FrameCutter
from tests.mavlink.link.builders import (
    Sender,
    UdpVehicle,
    attitude,
    attitude_at,
    free_port,
    heartbeat,
    wait_until,
)

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


def test_an_unanswered_request_is_repeated_with_its_confirmation_counted_up_then_rests() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    sent = [request.speak(VEHICLE, float(i)) for i in range(5)]
    assert [message.confirmation for (message,) in sent] == [0, 1, 2, 3, 4]
    assert request.speak(VEHICLE, 5.0) == []
    assert request.answers == {"ATTITUDE": "no answer"}
    (sentence,) = request.report()
    assert "SYSID_MYGCS (MAV_GCS_SYSID)" in sentence


def test_a_deaf_vehicle_is_asked_ever_more_seldom_but_never_given_up() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    asked = [tick / 10 for tick in range(6000) if request.speak(VEHICLE, tick / 10)]
    later = [at_s for at_s in asked if at_s > 300.0]
    assert 3 <= len(later) <= 6
    assert len(request.report()) == 1


def test_what_was_not_answered_is_asked_again_as_soon_as_the_vehicle_answers_anything() -> None:
    request = RateRequest({"ATTITUDE": 50.0, "AOA_SSA": 20.0})
    asked = []
    for tick in range(200):
        now_s = tick / 10
        for message in request.speak(VEHICLE, now_s):
            asked.append((now_s, message.param1))
            if now_s > 6.0:
                answer(request, dialect.MAV_RESULT_ACCEPTED, now_s)
    assert request.answers == {"ATTITUDE": "granted", "AOA_SSA": "granted"}
    assert min(at_s for at_s, message in asked if message == 30 and at_s > 6.0) < 8.0


@pytest.mark.parametrize("result", [dialect.MAV_RESULT_DENIED, dialect.MAV_RESULT_TEMPORARILY_REJECTED])
def test_a_refused_request_is_asked_again_after_a_rest(result: int) -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    answer(request, result, 0.1)
    assert request.speak(VEHICLE, 5.0) == []
    assert len(request.speak(VEHICLE, 5.2)) == 1  # five seconds after the refusal
    answer(request, dialect.MAV_RESULT_ACCEPTED, 6.0)
    assert request.answers == {"ATTITUDE": "granted"}


def test_nothing_is_asked_while_the_vehicle_is_not_heard_and_no_request_is_lost_by_it() -> None:
    request = RateRequest({"ATTITUDE": 50.0, "AOA_SSA": 20.0})
    request.speak(VEHICLE, 0.0)
    assert [request.speak(None, 0.1 * k) for k in range(1, 100)] == [[]] * 99
    (again,) = request.speak(VEHICLE, 10.0)
    assert again.param1 == 30
    assert request.answers == {}


def test_after_a_reboot_everything_is_asked_again_and_no_rate_is_called_fallen() -> None:
    request = RateRequest({"ATTITUDE": 50.0, "AOA_SSA": 20.0})
    asked = []
    for tick in range(20 * 50):
        now_s = tick / 50
        boot_ms = 100_000 + 20 * tick if now_s < 10.0 else 20 * (tick - 500)
        if now_s < 10.0 or tick % 12 == 0:
            hear(request, attitude(boot_ms), now_s)
        for message in request.speak(VEHICLE, now_s):
            asked.append((now_s, message.param1))
            answer(request, dialect.MAV_RESULT_ACCEPTED, now_s)
    assert {message for at_s, message in asked if 10.0 < at_s < 12.0} == {30, 11020}
    said = " ".join(request.report())
    assert "the vehicle rebooted: every rate is requested again" in said
    assert "ATTITUDE fell" not in said


def test_on_leaving_every_rate_asked_for_goes_back_to_its_default_until_the_vehicle_answers() -> None:
    request = RateRequest({"ATTITUDE": 50.0, "AOA_SSA": 20.0})
    for _ in range(2):
        request.speak(VEHICLE, 0.0)
        answer(request, dialect.MAV_RESULT_ACCEPTED, 0.0)
    sent = request.leave(10.0)
    assert sent is not None
    assert [(message.param1, message.param2) for message in sent] == [(30, 0.0), (11020, 0.0)]
    assert request.leave(10.1) == []
    assert [message.confirmation for message in request.leave(10.3) or ()] == [1, 1]
    answer(request, dialect.MAV_RESULT_ACCEPTED, 10.4)
    answer(request, dialect.MAV_RESULT_ACCEPTED, 10.4)
    assert request.leave(10.4) is None


def test_a_deaf_vehicle_is_asked_three_times_to_put_a_rate_back() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    answer(request, dialect.MAV_RESULT_ACCEPTED, 0.1)
    sent = [request.leave(10.0 + 0.3 * k) for k in range(4)]
    assert [len(messages or ()) for messages in sent] == [1, 1, 1, 0]
    assert sent[-1] is None


def test_who_asked_for_nothing_has_nothing_to_put_back() -> None:
    assert RateRequest({"ATTITUDE": 50.0}).leave(0.0) is None


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
        hear(request, attitude(40 * i), 0.1 + i / 25)
    request.speak(VEHICLE, 3.1)
    assert request.delivered_hz == {"ATTITUDE": 25.0}
    assert request.report() == ["delivered: ATTITUDE 25.0 Hz of 50 asked"]


def cut_in_flight(request: RateRequest, until_s: float) -> list[float]:
    """When a rate was asked for, of a vehicle that grants 50 Hz and whose rate is 4 Hz after 20 s."""
    asked_at = []
    for tick in range(int(until_s * 50)):
        now_s = tick / 50
        if tick % 12 == 0 or now_s < 20:
            hear(request, attitude(20 * tick), now_s)
        for message in request.speak(VEHICLE, now_s):
            asked_at.append(now_s)
            assert message.param1 == 30
            answer(request, dialect.MAV_RESULT_ACCEPTED, now_s)
    return asked_at


def test_a_rate_taken_away_in_flight_is_told_and_asked_against_at_once_then_after_rests() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    asked_at = cut_in_flight(request, 300.0)[1:]
    assert 20.0 < asked_at[0] < 27.0  # two measurements of 3 s
    assert asked_at[2] - asked_at[0] < 12.0
    assert all(later - earlier <= 64.0 for earlier, later in pairwise(asked_at))
    assert len([at_s for at_s in asked_at if at_s > 120.0]) <= 4
    told = [sentence for sentence in request.report() if "rates fell" in sentence]
    assert len(told) == 1
    assert "ATTITUDE 4." in told[0]
    assert "--streamrate=-1" in told[0]


def test_a_ground_station_at_work_is_named_with_its_cure() -> None:
    request = RateRequest({"ATTITUDE": 50.0})
    request.speak(VEHICLE, 0.0)
    station = Sender(system=252, component=190)
    (frame,) = FrameCutter(CRC_EXTRA).feed(station.pack(heartbeat(dialect.MAV_TYPE_GCS, 8)))
    request.hear(frame, 0.0)
    cut_in_flight(request, 40.0)
    (told,) = [sentence for sentence in request.report() if "rates fell" in sentence]
    assert "ground station 252 is at work on this link" in told
    assert "MAVProxy with --streamrate=-1" in told


def test_a_stream_below_2_hz_a_pause_and_a_reboot_raise_no_alarm_of_rates() -> None:
    watch, said = RateWatch(), []
    for k, at_s in enumerate(np.cumsum(np.random.default_rng(0).uniform(0.4, 1.4, 200)).tolist()):
        said += watch.look(attitude_at(at_s), at_s if k < 100 else at_s + 30.0)
    assert said == []
    for tick in range(20 * 50):
        if tick == 500:
            watch.restart()
        if tick < 500 or tick % 12 == 0:
            said += watch.look(attitude_at(tick / 50), 1000.0 + tick / 50)
    assert said == []


@pytest.mark.parametrize(("hang_s", "kept_s"), [(1.2, 1.0), (2.0, 1.0), (7.0, 1.0), (12.0, 12.0)])
def test_packets_that_waited_while_the_computer_slept_are_no_faster_stream(hang_s, kept_s):
    """The socket keeps some seconds of packets; those of the rest of a hang are lost."""
    watch, sender, said = RateWatch(), Sender(), []
    for tick in range(40 * 50):
        sent_s = tick / 50
        if 10.0 + min(hang_s, kept_s) < sent_s < 10.0 + hang_s:
            continue
        (frame,) = FrameCutter(CRC_EXTRA).feed(sender.pack(attitude(20 * tick)))
        said += watch.look([frame], max(sent_s, 10.0 + hang_s) if sent_s >= 10.0 else sent_s)
    assert said == []


def test_over_a_link_rates_go_back_to_their_defaults_when_the_advisor_leaves() -> None:
    port = free_port()
    vehicle = UdpVehicle(port)
    request = RateRequest({"ATTITUDE": 50.0})
    with Link(f"udpin:127.0.0.1:{port}", talkers=[request]):
        vehicle.send(heartbeat())
        assert vehicle.hear().param2 == 20_000.0
        vehicle.send(dialect.MAVLink_command_ack_message(SET_INTERVAL, dialect.MAV_RESULT_ACCEPTED))
        wait_until(lambda: request.answers == {"ATTITUDE": "granted"})
    back = vehicle.hear()
    assert (back.get_type(), back.param1, back.param2) == ("COMMAND_LONG", 30, 0.0)
    vehicle.close()


def test_nothing_is_sent_into_a_silence_and_the_request_comes_when_the_vehicle_is_back() -> None:
    port = free_port()
    vehicle = UdpVehicle(port)
    request = RateRequest({"ATTITUDE": 50.0})
    with Link(f"udpin:127.0.0.1:{port}", talkers=[request]):
        vehicle.send(heartbeat())
        vehicle.socket.settimeout(4.5)  # after 3 s of silence the vehicle is out of reach
        heard = 0
        with contextlib.suppress(TimeoutError):
            while vehicle.hear():
                heard += 1
        assert heard <= 4
        assert request.answers == {}
        vehicle.send(heartbeat())
        vehicle.send(heartbeat())
        assert vehicle.hear().param1 == 30
    vehicle.close()


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
