from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, ElevatorOutput
from advisor.doctor.examination import Examination, Limit
from advisor.doctor.examiner import Examiner
from advisor.doctor.text import doctor_document
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from tests.doctor.builders import flight, heartbeat
from tests.flights import SHIPPED, calm_two

WELL_KNOWN = Aircraft(
    elevator=Elevator(calibration=((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), lag_s=0.05, delay_s=0.0)
)


def examined(columns, aircraft=WELL_KNOWN, lost=None):
    examiner = Examiner(aircraft)
    examiner.feed(columns)
    return examiner.findings(lost)


def limits(found: Examination) -> dict[str, Limit]:
    return {limit.code: limit for limit in found.limits}


def with_vane(columns: list[Columns]) -> list[Columns]:
    """The same link with a vane's named value instead of the autopilot's estimate."""
    alpha = next(part for part in columns if part.name == "AOA_SSA")
    fields = {
        "time_boot_ms": (alpha.fields["time_usec"] // 1000).astype(np.uint32),
        "name": np.full(len(alpha), b"alpha", dtype="S10"),
        "value": np.radians(alpha.fields["AOA"]),
    }
    vane = Columns("NAMED_VALUE_FLOAT", 1, 1, alpha.order, alpha.arrival_s, fields)
    return [vane if part.name == "AOA_SSA" else part for part in columns]


def test_fast_telemetry_with_a_vane_and_a_known_servo_is_ready() -> None:
    aircraft = replace(WELL_KNOWN, alpha=replace(WELL_KNOWN.alpha, source="named_value:alpha"))
    found = examined(with_vane(flight()), aircraft)
    assert limits(found) == {}
    assert found.verdict == "ready"
    assert found.alpha is not None
    assert found.alpha.provenance == "vane"


def test_what_the_autopilot_derives_is_a_limit_and_says_so() -> None:
    found = examined(flight())
    assert limits(found).keys() == {"alpha_derived"}
    assert found.verdict == "usable with limits"
    assert found.alpha is not None
    assert (found.alpha.source, found.alpha.provenance) == ("AOA_SSA", "derived")


def test_default_rates_are_not_usable_and_every_limit_names_message_rate_number_and_both_spellings() -> None:
    found = examined(flight(4.0, 60.0, SERVO_OUTPUT_RAW=2.0))
    assert found.verdict == "not usable"
    stopping = [limit for limit in found.limits if limit.stops]
    told = {limit.text.split()[0]: limit for limit in stopping}
    assert told.keys() == {"ATTITUDE", "SERVO_OUTPUT_RAW"}
    told |= {limit.text.split()[0]: limit for limit in found.limits if "AOA_SSA arrives" in limit.text}
    assert "arrives at 4.0 Hz" in told["AOA_SSA"].text
    assert "arrives at 2.0 Hz" in told["SERVO_OUTPUT_RAW"].text
    assert "SR0_EXTRA1 (MAV1_EXTRA1) to 50" in told["AOA_SSA"].fix
    assert "message 11020" in told["AOA_SSA"].fix
    assert "SR0_RC_CHAN (MAV1_RC_CHAN) to 50" in told["SERVO_OUTPUT_RAW"].fix
    assert all("--request-rates" in limit.fix for limit in stopping)
    assert told["SERVO_OUTPUT_RAW"].std_ratio["M_delta_e"] > 3.0


def test_whether_a_rate_is_enough_depends_on_the_aircraft() -> None:
    jet = {
        "Z_alpha": -0.483,
        "Z_q": 0.104,
        "Z_delta_e": 0.676,
        "M_alpha": -4.93,
        "M_q": -2.01,
        "M_delta_e": -7.21,
    }
    slow = flight(10.0, 40.0)
    assert "rate" in limits(examined(slow))
    of_the_jet = examined(slow, replace(WELL_KNOWN, model=jet))
    assert "rate" not in limits(of_the_jet)
    assert of_the_jet.assumed.source == "the model in the aircraft file"
    twitchy = {"Z_alpha": -8.0, "M_alpha": -300.0, "M_q": -8.0, "M_delta_e": -300.0}
    assert examined(slow, replace(WELL_KNOWN, model=twitchy)).verdict == "not usable"


def test_a_staircase_is_judged_by_its_renewals() -> None:
    found = examined(flight(renewed=10.0))
    assert "changes only at 10.0 Hz" in limits(found)["renewal"].text
    assert not limits(found)["renewal"].stops
    assert limits(found)["renewal"].std_ratio["Z_alpha"] > 1.0


@pytest.mark.parametrize(
    ("without", "code", "stops"),
    [
        ("SERVO_OUTPUT_RAW", "no_elevator", True),
        ("ATTITUDE", "no_pitch_rate", True),
        ("HEARTBEAT", "no_vehicle", True),
        ("RAW_IMU", "no_accelerometer", False),
        ("VFR_HUD", "no_airspeed", False),
    ],
)
def test_what_is_missing_is_named(without: str, code: str, stops: bool) -> None:
    found = examined(flight(without=[without]))
    assert limits(found)[code].stops is stops
    assert (found.verdict == "not usable") is stops


def test_without_any_alpha_nothing_works_and_a_derived_one_is_a_limit() -> None:
    assert limits(examined(flight(without=["AOA_SSA", "VFR_HUD"])))["no_alpha"].stops
    derived = examined(flight(without=["AOA_SSA"]))
    assert "MAVLink 2" in limits(derived)["alpha_derived"].fix
    assert derived.verdict == "usable with limits"


def test_a_missing_accelerometer_costs_what_the_sensitivities_say() -> None:
    cost = limits(examined(flight(without=["RAW_IMU"])))["no_accelerometer"].std_ratio
    assert cost["Z_delta_e"] > 1.2
    assert all(ratio > 0.99 for ratio in cost.values())


def test_elevons_and_v_tails_are_read_together_and_a_lone_half_is_refused_by_name() -> None:
    elevons = {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0}
    found = examined(flight(setup=elevons), Aircraft())
    assert found.elevator is not None
    assert found.elevator.outputs == (1, 2)
    assert found.elevator.resolution_deg == pytest.approx(25.0 / 400.0 / 2.0)
    assert limits(found)["calibration"].text.startswith("Outputs 1 and 2 are not calibrated")
    tail = examined(flight(setup={"SERVO3_FUNCTION": 79.0, "SERVO2_FUNCTION": 80.0}), Aircraft())
    assert tail.elevator is not None
    assert tail.elevator.outputs == (2, 3)
    half = examined(flight(setup={"SERVO1_FUNCTION": 77.0}), Aircraft())
    assert half.verdict == "not usable"
    assert "elevon" in limits(half)["no_elevator"].text


def test_the_resolution_of_the_command_is_its_smallest_step_in_degrees() -> None:
    found = examined(flight())
    assert found.elevator is not None
    assert found.elevator.resolution_deg == pytest.approx(0.05)
    assert found.elevator.calibrated
    from_parameters = examined(flight(), Aircraft())
    assert from_parameters.elevator is not None
    assert from_parameters.elevator.resolution_deg == pytest.approx(25.0 / 400.0)
    assert {"calibration", "servo_unknown"} <= limits(from_parameters).keys()
    coarse = Elevator(calibration=((1490.0, 25.0), (1510.0, -25.0)), lag_s=0.0)
    assert "2.50 deg" in limits(examined(flight(), Aircraft(elevator=coarse)))["resolution"].text


def test_outputs_of_the_file_are_listed_and_the_coarsest_decides_the_resolution() -> None:
    fine, coarse = ((1000.0, -5.0), (2000.0, 5.0)), ((1000.0, 25.0), (2000.0, -25.0))
    outputs = (ElevatorOutput(2, coarse, 3.0), ElevatorOutput(1, fine))
    found = examined(flight(setup={}), Aircraft(elevator=Elevator(outputs=outputs, lag_s=0.05)))
    assert found.elevator is not None
    assert found.elevator.outputs == (1, 2)
    assert found.elevator.calibrated
    assert found.elevator.resolution_deg == pytest.approx(0.75 * 0.05)


def test_without_parameters_the_output_is_asked_for() -> None:
    found = examined(flight(setup={}), Aircraft())
    assert limits(found)["no_elevator"].stops
    assert "--request-rates" in limits(found)["no_elevator"].fix
    named = examined(flight(setup={}), Aircraft(elevator=Elevator(output=2)))
    assert named.verdict == "usable with limits"


def test_a_second_vehicle_is_named_with_the_option_that_chooses() -> None:
    other = Columns("HEARTBEAT", 7, 1, np.array([5]), np.array([0.0]), heartbeat().fields)
    found = examined([*flight(), other])
    assert "--target-system 7" in limits(found)["several_vehicles"].fix


def test_losses_of_a_live_link_count() -> None:
    assert "12.0 % of the packets are lost" in limits(examined(flight(), lost=12.0))["loss"].text
    assert "loss" not in limits(examined(flight(), lost=1.0))


def test_on_px4_the_words_are_px4s() -> None:
    found = examined(flight(4.0, 60.0, autopilot=12), Aircraft(elevator=Elevator(output=2)))
    assert all("SR0_" not in limit.fix for limit in found.limits)
    assert any("-s ATTITUDE -r 50" in limit.fix for limit in found.limits)


@cache
def examined_log(log: Path) -> Examination:
    examiner = Examiner(Aircraft())
    for columns in open_log(log):
        examiner.feed(columns)
    return examiner.findings()


def test_a_recorded_calm_flight_is_usable_with_limits() -> None:
    found = examined_log(calm_two())
    assert found.verdict == "usable with limits"
    assert "renewal" in limits(found)
    assert found.alpha is not None
    assert found.alpha.renewed_hz == pytest.approx(20.0, abs=0.5)
    assert "manoeuvres flown" in found.assumed.source
    messages = {message.name: message for message in found.messages}
    assert messages["ATTITUDE"].rate_hz == pytest.approx(50.0, abs=0.5)


def test_a_recorded_flight_at_default_rates_is_not_usable() -> None:
    found = examined_log(SHIPPED / "arduplane-default-rates.tlog")
    assert found.verdict == "not usable"
    assert found.expectation is not None


def test_a_model_is_believed_only_when_the_motion_bears_it_out() -> None:
    """Elevator steps, but alpha and pitch rate that have nothing to do with them."""
    columns = flight(seconds=60.0)
    servo = next(part for part in columns if part.name == "SERVO_OUTPUT_RAW")
    t = servo.fields["time_usec"] * 1e-6
    for begin, end, pulse in ((20.0, 21.2, 1450), (21.2, 22.0, 1550), (22.0, 22.4, 1450), (22.4, 22.8, 1550)):
        servo.fields["servo2_raw"][(t >= begin) & (t < end)] = pulse
    found = examined(columns)
    assert "a typical aircraft" in found.assumed.source
    assert found.expectation is not None
    assert found.expectation.amplitude_deg < 25.0


def test_the_document_keeps_the_contract() -> None:
    document = doctor_document(examined_log(calm_two()))
    assert document["schema"] == "advisor.doctor/1"
    assert document["usable"] is True
    assert document["verdict"] == "usable with limits"
    assert document["vehicle"] == {"system": 1, "component": 1, "autopilot": "ardupilot", "firmware": None}
    assert {"name", "rate_hz", "jitter_ms", "largest_gap_s", "renewed_hz"} <= document["messages"][0].keys()
    assert document["elevator"]["output"] == 2
    assert document["elevator"]["calibrated"] is False
    assert document["alpha"]["source"] == "AOA_SSA"
    assert {"code", "text", "fix"} <= document["limits"][0].keys()
    assert len(document["expected_std"]) == 8
    assert document["problems"] == []


def changed(columns: list[Columns], message: str, **fields: object) -> list[Columns]:
    """The link with fields of one message replaced, each by one value or by one a message."""
    part = next(part for part in columns if part.name == message)
    wrong = {name: np.broadcast_to(np.asarray(value), (len(part),)).copy() for name, value in fields.items()}
    mended = replace(part, fields={**part.fields, **wrong})
    return [mended if part.name == message else part for part in columns]


def moving(columns: list[Columns]) -> list[Columns]:
    """The link with the pitch angle that belongs to its pitch rate."""
    t = next(part for part in columns if part.name == "ATTITUDE").fields["time_boot_ms"] * 1e-3
    return changed(columns, "ATTITUDE", pitch=-np.cos(7.0 * t) / 7.0)


def test_a_pitch_rate_that_stands_still_while_the_attitude_moves_is_not_usable() -> None:
    found = examined(changed(moving(flight()), "ATTITUDE", pitchspeed=0.0))
    assert found.verdict == "not usable"
    assert limits(found)["frozen"].stops


@pytest.mark.parametrize(
    ("message", "fields", "name"),
    [
        ("RAW_IMU", {"zacc": 0}, "Normal acceleration"),
        ("AOA_SSA", {"AOA": 3.0}, "Angle of attack"),
        ("VFR_HUD", {"airspeed": 25.0}, "Air speed"),
    ],
)
def test_any_channel_that_stands_still_is_named(message: str, fields: dict[str, float], name: str) -> None:
    limit = limits(examined(changed(moving(flight()), message, **fields)))["frozen"]
    assert limit.text.startswith(f"{name} stands still")
    assert not limit.stops


def test_what_is_missing_and_what_is_slow_are_told_in_one_answer() -> None:
    found = limits(examined(flight(setup={}, ATTITUDE=4.0, without=["SERVO_OUTPUT_RAW"])))
    assert {"no_elevator", "rate"} <= found.keys()


def test_two_banks_of_outputs_are_not_added_up() -> None:
    columns = flight(SERVO_OUTPUT_RAW=5.0)
    first = next(part for part in columns if part.name == "SERVO_OUTPUT_RAW")
    second = replace(
        first, order=first.order + 1, fields={**first.fields, "port": np.ones(len(first), np.uint8)}
    )
    found = examined([*columns, second])
    rates = {arrival.name: arrival.rate_hz for arrival in found.messages}
    assert rates["SERVO_OUTPUT_RAW"] == pytest.approx(5.0, rel=0.01)
    assert limits(found)["rate"].stops
    assert "SERVO_OUTPUT_RAW arrives at 5.0 Hz" in limits(found)["rate"].text


def test_a_rate_is_that_of_the_best_stretch_not_of_the_last_seconds() -> None:
    columns = flight(seconds=60.0)
    master = next(part for part in columns if part.name == "ATTITUDE")
    t = master.fields["time_boot_ms"] * 1e-3
    thinned = (t < 40.0) | (np.arange(len(t)) % 25 == 0)
    slow = replace(
        master,
        order=master.order[thinned],
        arrival_s=master.arrival_s[thinned],
        fields={name: values[thinned] for name, values in master.fields.items()},
    )
    found = limits(examined([slow if part is master else part for part in columns]))
    assert "rate" not in found
    assert "rate_fell" in found


def test_a_multicopter_is_told_what_analyze_tells() -> None:
    columns = [heartbeat(autopilot=12, kind=2), *flight(autopilot=12, setup={})[1:]]
    stream = FlightStream(Aircraft())
    stream.feed(columns)
    stream.finish()
    (problem,) = stream.problems()
    (limit,) = (limit for limit in examined(columns, Aircraft()).limits if limit.stops)
    assert (limit.code, f"{limit.text}.") == ("multicopter", problem.text)
