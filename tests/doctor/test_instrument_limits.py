"""Each limit of an instrument or a clock, on hand-made evidence on both sides of its number."""

from dataclasses import replace
from math import nan

import pytest

from advisor.aircraft.aircraft import Elevator
from advisor.doctor.examination import ElevatorFound
from advisor.doctor.limits import (
    Paced,
    alpha_limits,
    clock_limits,
    clock_notes,
    company_limits,
    cost_of_missing,
    distrust_limits,
    elevator_limits,
    path_limits,
    rate_limits,
    repeat_limits,
    steadiness_limits,
)
from advisor.doctor.survey import Arrival, Clocks
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.trust import Distrust
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.model.short_period import ShortPeriod
from advisor.words.problems import Problem
from tests.doctor.test_limits import ASSUMED
from tests.rows import row

PLANE = Vehicle(1, 1, "ardupilot", 1)
SOUND = Clocks(boots=1, drift_percent=0.0, arrival_jitter_ms=2.0, strayed={})


def alpha(source: str, provenance: str, vehicle: Vehicle = PLANE) -> list[str]:
    return [limit.fix for limit in alpha_limits(ChannelStatus(source, provenance, 50.0, 0.1, 9.0), vehicle)]


def test_a_vane_is_no_limit_and_a_derived_angle_is_one() -> None:
    assert alpha("AOA_SSA.AOA", "measured") == []
    assert alpha("AOA_SSA.AOA", "derived")[0].startswith("fly in calm air")


def test_only_ardupilot_is_asked_for_aoa_ssa_by_a_rate_on_a_link_and_by_a_record_in_a_log() -> None:
    (link,) = alpha("theta", "derived")
    (log,) = alpha("theta", "derived", replace(PLANE, carrier="dataflash"))
    (px4,) = alpha("theta", "derived", Vehicle(1, 1, "px4", 1))
    assert link.startswith("ask for AOA_SSA over MAVLink 2")
    assert not log.startswith("ask for")
    assert log.count("fit a vane") == 1 < len(log.split("; or "))
    assert px4.startswith("fit a vane")


def servo(
    *outputs: int, calibrated: bool = True, deg: float = 0.1, doubts: tuple[Problem, ...] = ()
) -> list[str]:
    found = ElevatorFound(outputs, deg, calibrated, doubts)
    return [f"{limit.text}: {limit.fix}" for limit in elevator_limits(found, Elevator(lag_s=0.05))]


def test_outputs_without_calibration_are_told_by_their_number() -> None:
    assert servo(2) == []
    (one,) = servo(2, calibrated=False)
    (two,) = servo(1, 2, calibrated=False)
    assert one.startswith("Output 2 is not calibrated: full travel, as the parameters state")
    assert "give elevator.calibration in" in one
    assert two.startswith("Outputs 1 and 2 are not")
    assert "elevator.outputs, each with its calibration," in two


def test_assumed_limits_are_a_defect_and_make_the_scale_assumed() -> None:
    doubt = Problem("servo_limits", "SERVO2_MIN is assumed.", "Record it.")
    limits, scale = servo(2, calibrated=False, doubts=(doubt,))
    assert limits == "SERVO2_MIN is assumed: record it"
    assert "full travel, whose pulses are assumed," in scale


def test_a_servo_without_a_stated_lag_is_told() -> None:
    codes = [limit.code for limit in elevator_limits(ElevatorFound((2,), 0.1, True), Elevator())]
    assert codes == ["servo_unknown"]


@pytest.mark.parametrize(
    ("code", "channel", "count"), [("frozen", "q", 0), ("units", "q", 1), ("frozen", "a_z", 1)]
)
def test_a_frozen_pitch_rate_alone_is_told_elsewhere(code: str, channel: str, count: int) -> None:
    assert len(distrust_limits([Distrust(code, channel, "it stands still", "mend it", 0.0)])) == count


def arrival(name: str = "ATTITUDE", hz: float = 50.0, **other: float) -> Arrival:
    sound = Arrival(name, 5000, hz, 1.0, 1.0 / hz, hz, hz)
    return replace(sound, **other)


@pytest.mark.parametrize(("share", "told"), [(0.65, 1), (0.75, 0)])
def test_a_message_repeats_values_where_less_than_seven_tenths_are_new(share: float, told: int) -> None:
    assert len(repeat_limits([arrival(renewed_hz=50.0 * share)])) == told


def test_only_messages_of_the_motion_repeat_by_a_second_stream() -> None:
    assert repeat_limits([arrival("SERVO_OUTPUT_RAW", renewed_hz=10.0)]) == []


@pytest.mark.parametrize(
    ("clocks", "codes"),
    [
        (SOUND, []),
        (replace(SOUND, boots=2), ["reboot"]),
        (replace(SOUND, strayed={"RAW_IMU": 0.009}), []),
        (replace(SOUND, strayed={"RAW_IMU": 0.011}), ["clock"]),
        (replace(SOUND, drift_percent=0.9), []),
        (replace(SOUND, drift_percent=1.1), ["clock_drift"]),
        (replace(SOUND, drift_percent=-1.1), ["clock_drift"]),
        (replace(SOUND, drift_percent=9.0), ["clock_drift"]),
        (replace(SOUND, drift_percent=11.0), []),
        (replace(SOUND, drift_percent=nan), []),
    ],
)
def test_a_clock_is_wrong_by_reboots_by_strays_and_by_drift(clocks: Clocks, codes: list[str]) -> None:
    assert [limit.code for limit in clock_limits(clocks)] == codes


@pytest.mark.parametrize(("percent", "simulated"), [(9.0, False), (11.0, True), (-11.0, True), (nan, False)])
def test_a_clock_that_is_off_by_a_tenth_is_a_simulators(percent: float, simulated: bool) -> None:
    assert bool(clock_notes(replace(SOUND, drift_percent=percent))) is simulated


def test_other_vehicles_are_told_where_there_are_some() -> None:
    assert company_limits([]) == []
    (limit,) = company_limits({9, 4})
    assert "--target-system 4" in limit.fix


@pytest.mark.parametrize(("percent", "told"), [(0.9, 0), (1.1, 1)])
def test_one_packet_in_a_hundred_that_comes_twice_is_a_second_path(percent: float, told: int) -> None:
    assert len(path_limits(percent, 0.2)) == told


def unsteady(carrier: str = "telemetry", period_s: float = 1.0, **other: float) -> list[str]:
    limits = steadiness_limits({"ATTITUDE": arrival(**other)}, {"ATTITUDE"}, period_s, carrier)  # type: ignore[arg-type]
    return [f"{limit.code}: {limit.fix}" for limit in limits]


@pytest.mark.parametrize(("lowest_hz", "fell"), [(29.0, True), (31.0, False)])
def test_a_message_was_interrupted_where_its_rate_fell_below_six_tenths(lowest_hz: float, fell: bool) -> None:
    assert [one.partition(":")[0] for one in unsteady(lowest_hz=lowest_hz)] == ["rate_fell"] * fell


@pytest.mark.parametrize(
    ("period_s", "hz", "gap_s", "told"),
    [
        (1.0, 50.0, 0.45, False),
        (1.0, 50.0, 0.55, True),
        (0.05, 50.0, 0.055, False),
        (0.05, 50.0, 0.065, True),
    ],
)
def test_a_gap_lasts_half_a_natural_period_and_three_intervals(period_s, hz, gap_s, told):
    assert bool(unsteady(period_s=period_s, hz=hz, largest_gap_s=gap_s)) is told


@pytest.mark.parametrize("other", [{"lowest_hz": 10.0}, {"largest_gap_s": 3.0}])
def test_a_log_drops_records_and_a_link_loses_packets(other: dict[str, float]) -> None:
    assert "could not write all records" in unsteady("dataflash", **other)[0]
    assert "radio link" in unsteady("telemetry", **other)[0]


def test_a_message_that_nobody_needs_may_come_as_it_likes() -> None:
    assert (
        steadiness_limits({"HEARTBEAT": arrival("HEARTBEAT", lowest_hz=1.0)}, {"ATTITUDE"}, 1.0, "telemetry")
        == []
    )


def slow(channels, name, hz, arrives_hz, speed):
    paced = {one: Paced(one, "ATTITUDE", 50.0, 50.0) for one in channels}
    paced[name] = Paced(name, "ATTITUDE", arrives_hz, hz)
    return [(limit.code, limit.stops) for limit in rate_limits(paced, ASSUMED, PLANE, speed)]


NO_FORCE = ("elevator", "q", "alpha")


WITH_FORCE = (*NO_FORCE, "a_z")


@row(
    "a slow angle that the motion replaces is allowed",
    WITH_FORCE, "alpha", 9.0, 9.0, 25.0, [("rate", False)],
)  # fmt: skip
@row("a slow angle without the force stops the flight", NO_FORCE, "alpha", 9.0, 9.0, 25.0, [("rate", True)])
@row("a slow angle without air speed stops the flight", WITH_FORCE, "alpha", 9.0, 9.0, None, [("rate", True)])
@row("a slow pitch rate stops the flight", WITH_FORCE, "q", 9.0, 9.0, 25.0, [("rate", True)])
@row(
    "a fast message of old values is renewed slowly",
    NO_FORCE, "alpha", 20.0, 50.0, 25.0, [("renewal", False)],
)  # fmt: skip
@row("a slow message with new values is slow", NO_FORCE, "alpha", 20.0, 20.0, 25.0, [("rate", False)])
@row("a channel that is missing has no rate", ("elevator", "q", "a_z"), "q", 50.0, 50.0, 25.0, [])
def test_the_limits_of_a_slow_channel(channels, name, hz, arrives_hz, speed, limits) -> None:
    assert slow(channels, name, hz, arrives_hz, speed) == limits


def test_a_missing_accelerometer_costs_more_the_faster_the_aircraft_flies() -> None:
    paced = {name: Paced(name, "ATTITUDE", 50.0, 50.0) for name in NO_FORCE}
    without, slowly, fast = (cost_of_missing("a_z", paced, ASSUMED, speed) for speed in (None, 25.0, 60.0))
    assert without["Z_q"] > 1.5
    assert fast["Z_q"] > 2.0 * slowly["Z_q"]


def test_an_aircraft_that_diverges_at_once_tells_no_cost() -> None:
    wild = replace(
        ASSUMED,
        model=ShortPeriod.from_mapping({"Z_alpha": -1.0, "M_alpha": 9e5, "M_q": -1.0, "M_delta_e": -9.0}),
    )
    paced = {name: Paced(name, "ATTITUDE", 50.0, 50.0) for name in NO_FORCE}
    assert cost_of_missing("a_z", paced, wild, 25.0) == {}
