"""A mend names what the link or log at hand can do: stream rates, LOG_BITMASK or SDLOG_PROFILE."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.stream.stream import FlightStream
from tests.flight.stream.test_suitability import flight


def problems(carrier, without=(), rate_hz=50.0, autopilot=3):
    stream = FlightStream(Aircraft(elevator=Elevator(output=2)))
    columns = flight(without=without, rate_hz=rate_hz, onsets=()).columns()
    for c in columns:
        if c.name == "HEARTBEAT":
            c.fields["autopilot"][:] = autopilot
    stream.feed([replace(c, carrier=carrier) for c in columns])
    stream.finish()
    return stream.problems()


def test_all_that_a_dataflash_log_lacks_is_one_sentence_with_records_and_bits():
    (problem,) = problems("dataflash", ("SERVO_OUTPUT_RAW", "AOA_SSA", "VFR_HUD", "RAW_IMU"))
    assert problem.code == "no_elevator"
    for record in ("RCOU", "AOA", "ARSP", "IMU"):
        assert f"({record})" in problem.text
    for bit in ("LOG_BITMASK", "RCOU by bit 13 (RC)", "AOA by bit 0 (ATTITUDE_FAST)", "IMU by bit 7 (IMU)"):
        assert bit in problem.fix


def test_all_that_a_ulog_lacks_is_one_sentence_with_its_topics():
    (problem,) = problems("ulog", ("SERVO_OUTPUT_RAW", "AOA_SSA", "VFR_HUD"), autopilot=12)
    assert "actuator_outputs" in problem.text
    assert "SDLOG_PROFILE" in problem.fix


@pytest.mark.parametrize("rate_hz", [4.0, 50.0])
@pytest.mark.parametrize("without", [(), ("ATTITUDE",), ("SERVO_OUTPUT_RAW",), ("AOA_SSA", "VFR_HUD")])
@pytest.mark.parametrize(
    ("carrier", "autopilot", "words"),
    [("telemetry", 3, "request-rates"), ("dataflash", 3, "LOG_BITMASK"), ("ulog", 12, "SDLOG_PROFILE")],
)
def test_no_mend_speaks_of_another_kind_of_log(carrier, autopilot, words, without, rate_hz):
    told = [str(p) for p in problems(carrier, without, rate_hz, autopilot) if p.code != "no_maneuver"]
    others = {"SR0_", "request-rates", "LOG_BITMASK", "SDLOG_PROFILE"} - {words}
    if carrier == "telemetry":
        others -= {"SR0_"}
    assert told or (rate_hz, without) == (50.0, ())
    assert all(words in sentence for sentence in told)
    assert not any(other in sentence for other in others for sentence in told)
