"""Each reason for which a stream cannot serve, on hand-made arrivals of channels."""

from dataclasses import replace
from math import nan

import pytest

from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.trust import Distrust
from advisor.flight.stream import suitability
from advisor.flight.vehicle.surfaces import Calibration, Part, Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem
from tests.rows import row

PLANE = Vehicle(1, 1, "ardupilot", 1)
LOG = replace(PLANE, carrier="dataflash")
CARRIERS = pytest.mark.parametrize("vehicle", [PLANE, LOG], ids=["telemetry", "log"])
SENT = ("ATTITUDE", "SERVO_OUTPUT_RAW")
MOTION = ("a_z", "airspeed", "theta")


def elevator(output: int = 2) -> Surface:
    return Surface((Part(output, Calibration(((1000.0, -25.0), (2000.0, 25.0)))),), True, "")


def arriving(*names: str, hz: float = 50.0, **slow: float) -> dict[str, ChannelStatus]:
    """Channels at this rate, and others at a rate of their own, each in a message of its name."""
    rates = {**dict.fromkeys(names, hz), **slow}
    return {name: ChannelStatus(f"{name}.x", "measured", rate, 0.1, 9.0) for name, rate in rates.items()}


def told(channels, vehicle=PLANE, surface=None, maneuvers=1, seen=SENT, others=(), activities=None, still=()):
    return suitability.problems(
        vehicle, others, surface or elevator(), channels, maneuvers, activities or {}, still, seen
    )


def codes(*given: object, **named: object) -> list[str]:
    return [problem.code for problem in told(*given, **named)]  # type: ignore[arg-type]


@CARRIERS
def test_a_measured_angle_of_attack_needs_no_accelerometer(vehicle: Vehicle) -> None:
    assert codes(arriving("elevator", "q", "alpha"), vehicle) == []


@CARRIERS
def test_the_motion_needs_no_angle_of_attack(vehicle: Vehicle) -> None:
    assert codes(arriving("elevator", "q", *MOTION), vehicle) == []


@CARRIERS
@pytest.mark.parametrize("missing", MOTION)
def test_the_motion_replaces_no_angle_of_attack_without_one_of_its_channels(vehicle, missing):
    there = [name for name in MOTION if name != missing]
    assert codes(arriving("elevator", "q", *there), vehicle) == ["no_alpha"]


def test_only_the_channels_that_are_missing_are_named() -> None:
    (problem,) = told(arriving("elevator", "q", "theta"))
    assert "no a_z nor airspeed arrived" in problem.text


def test_only_ardupilot_is_asked_for_its_message_of_the_angle_of_attack() -> None:
    (ardupilot,) = told(arriving("elevator", "q"))
    (other,) = told(arriving("elevator", "q"), replace(PLANE, autopilot="generic"))
    assert "AOA_SSA" in ardupilot.fix
    assert "AOA_SSA" not in other.fix


@pytest.mark.parametrize(("hz", "found"), [(7.9, ["rate"]), (8.0, [])])
@pytest.mark.parametrize("name", ["elevator", "q", "alpha"])
def test_eight_samples_a_second_are_the_least_of_each_needed_channel(name, hz, found):
    assert codes(arriving("elevator", "q", "alpha", **{name: hz})) == found


def test_a_channel_of_one_sample_arrives_hardly_at_all() -> None:
    (problem,) = told(arriving("q", "alpha", elevator=nan))
    assert "arrives hardly at all" in problem.text


def test_an_angle_derived_from_the_climb_is_as_fast_as_vfr_hud() -> None:
    derived = {"alpha": ChannelStatus("theta - climb", "derived", 4.0, 0.1, 9.0)}
    (problem,) = told(arriving("elevator", "q") | derived)
    assert problem.text.startswith("VFR_HUD arrives at 4.0 Hz")


@CARRIERS
@pytest.mark.parametrize(
    ("output", "seen", "pulseless"), [(16, SENT, True), (17, SENT, False), (2, ("ATTITUDE",), False)]
)
def test_an_output_has_no_pulse_where_the_message_of_the_first_sixteen_arrives(
    vehicle: Vehicle, output: int, seen: tuple[str, ...], pulseless: bool
) -> None:
    (problem,) = told(arriving("q", "alpha"), vehicle, elevator(output), seen=seen)
    assert problem.code == "no_elevator"
    assert ("it is 0 throughout" in problem.text) == pulseless


@CARRIERS
def test_without_a_pitch_rate_nothing_says_that_an_output_has_no_pulse(vehicle: Vehicle) -> None:
    assert not any("0 throughout" in problem.text for problem in told(arriving("alpha"), vehicle))


@CARRIERS
def test_an_unknown_elevator_is_one_problem(vehicle: Vehicle) -> None:
    unknown = Problem("no_elevator", "No output is the elevator.", "Set elevator.output.")
    assert told(arriving("q", "alpha"), vehicle, unknown) == [unknown]


@pytest.mark.parametrize(
    ("channels", "named", "silent"),
    [
        (("q", "elevator"), ["angle of attack", "air speed", "specific force"], ["pitch rate", "pulse"]),
        (("q", "elevator", "airspeed"), ["angle of attack", "specific force"], ["air speed"]),
        (("q", "elevator", "a_z"), ["angle of attack", "air speed"], ["specific force"]),
        (("q", "elevator", "airspeed", "a_z"), ["angle of attack"], ["air speed", "specific force"]),
        (("q", "alpha", "a_z"), ["pulse of servo output 2"], ["angle of attack", "air speed"]),
        (("elevator", "alpha"), ["pitch rate", "specific force"], ["pulse", "angle of attack", "air speed"]),
    ],
)
def test_a_log_names_everything_that_it_lacks_in_one_sentence(channels, named, silent):
    (problem,) = told(arriving(*channels), LOG, seen=())
    assert [what for what in named if f"no {what}" not in problem.text] == []
    assert [what for what in silent if f"no {what}" in problem.text] == []
    assert ("airspeed_m_s" in problem.fix) == ("air speed" in named)


def test_movements_are_counted_from_the_second_on() -> None:
    moved = {"a pulse": 1, "a doublet": 2}
    (problem,) = told(arriving("elevator", "q", "alpha"), maneuvers=0, activities=moved)
    assert problem.text.endswith("of the elevator: a pulse; a doublet (2 times).")


WHOLE = arriving("elevator", "q", "alpha")
BY_MOTION = arriving("elevator", "q", *MOTION)
NO_ALPHA = arriving("elevator", "q")
SLOW = arriving("alpha", elevator=2.0)


def frozen(channel: str) -> dict[str, object]:
    return {"still": [Distrust("frozen", channel, f"{channel} stands still", "restart it", 0.0)]}


@row("a frozen accelerometer replaces no angle of attack", BY_MOTION, frozen("a_z"), ["no_alpha"])
@row("a frozen air speed hinders nothing", BY_MOTION, frozen("airspeed"), [])
@row("a frozen pitch rate is a problem of its own", WHOLE, frozen("q"), ["frozen"])
@row("a frozen accelerometer is no problem beside a vane", WHOLE, frozen("a_z"), [])
@row("an angle that the motion replaces may be slow", arriving("elevator", "q", *MOTION, alpha=4.0), {}, [])
@row("without a pitch rate no rate is judged", SLOW, {}, ["no_pitch_rate", "no_alpha"])
@row("in a log no rate is judged without a pitch rate", SLOW, {"vehicle": LOG}, ["no_pitch_rate"])
@row("no manoeuvre is a problem", WHOLE, {"maneuvers": 0}, ["no_maneuver"])
@row("a missing manoeuvre is not told beside another problem", NO_ALPHA, {"maneuvers": 0}, ["no_alpha"])
@row("one manoeuvre is enough", WHOLE, {"maneuvers": 1}, [])
@row("another vehicle is named", NO_ALPHA, {"others": (7, 5)}, ["other_vehicles", "no_alpha"])
@row("another vehicle is not named where the followed one serves", WHOLE, {"others": (7,)}, [])
@row(
    "pulses and angle are not called missing",
    {}, {"seen": ("SERVO_OUTPUT_RAW", "AOA_SSA")}, ["no_pitch_rate"],
)  # fmt: skip
@row(
    "PX4's pulses are not called missing",
    {}, {"seen": ("ACTUATOR_OUTPUT_STATUS", "AOA_SSA")}, ["no_pitch_rate"],
)  # fmt: skip
@row(
    "pulses that did not come are called missing",
    {}, {"seen": ("AOA_SSA",)}, ["no_pitch_rate", "no_elevator"],
)  # fmt: skip
@row(
    "an angle by motion is not called missing",
    {}, {"seen": ("SERVO_OUTPUT_RAW", "RAW_IMU", "VFR_HUD")}, ["no_pitch_rate"],
)  # fmt: skip
def test_the_problems_of_a_stream(channels, more, found: list[str]) -> None:
    assert codes(channels, **more) == found
