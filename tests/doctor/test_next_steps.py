"""The doctor ends with three commands that fit what was examined."""

import pytest

from advisor.doctor.examination import Examination, ExaminedInput, Limit, next_commands
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed
from advisor.flight.vehicle.vehicle import Vehicle
from tests.printed import taken

SLOW = Limit("rate", "too slow", "ask for more", stops=True)
LOST = Limit("no_elevator", "no elevator", "name it", stops=True)
QUAD = Limit("multicopter", "a multicopter", "another log", stops=True)
TWO = Limit("several_vehicles", "two are heard", "choose one")


def _found(*limits: Limit) -> Examination:
    vehicle = Vehicle(7, 1, "ardupilot", 1)
    return Examination(vehicle, (), None, None, None, limits, None, Assumed(TYPICAL, NOISE, "none"))


def _log(name: str = "a.tlog", **known: object) -> ExaminedInput:
    return ExaminedInput(name, True, **known)  # type: ignore[arg-type]


LINK = ExaminedInput("udpin:0.0.0.0:14550", False)
EVERY = [
    (limits, examined)
    for limits in ((), (SLOW,), (LOST,), (QUAD,), (TWO,))
    for examined in (_log(), _log("my log.bin", aircraft_file="a b.yaml"), _log(has_model=True), LINK)
]


def test_a_log_without_an_aircraft_file_gets_one() -> None:
    assert next_commands(_found(), _log())[0] == "advisor aircraft new --from a.tlog -o aircraft.yaml"


def test_an_aircraft_file_is_checked_and_named_in_every_command() -> None:
    commands = next_commands(_found(), _log(aircraft_file="mine.yaml"))
    assert commands[0] == "advisor aircraft check mine.yaml --log a.tlog"
    assert all("mine.yaml" in command for command in commands)


def test_a_model_leads_to_the_gap_and_no_model_to_the_report() -> None:
    assert next_commands(_found(), _log(has_model=True))[2].startswith("advisor gap")
    assert next_commands(_found(), _log())[2].startswith("advisor report")


def test_slow_telemetry_leads_to_faster_streams_on_the_next_flight() -> None:
    assert "--request-rates" in next_commands(_found(SLOW), _log())[1]
    assert "--request-rates" in next_commands(_found(SLOW), LINK)[0]


def test_a_multicopter_leads_to_the_sample_flight() -> None:
    assert "advisor sample" in next_commands(_found(QUAD), _log())


def test_one_of_several_vehicles_is_named() -> None:
    assert all("--target-system 7" in command for command in next_commands(_found(TWO), _log()))


def test_a_link_that_serves_is_flown_on_at_once() -> None:
    assert next_commands(_found(), LINK)[0].startswith("advisor live --master udpin:0.0.0.0:14550")


@pytest.mark.parametrize(("limits", "examined"), EVERY)
def test_every_command_is_one_that_the_advisor_takes(limits, examined):
    for line in next_commands(_found(*limits), examined):
        taken(line)
