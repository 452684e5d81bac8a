"""A flight nobody here simulated: every manoeuvre found where it was flown, none invented."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.maneuvers.maneuver import ManeuverFlown, SideManeuverFlown
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.formats.telemetry import read_tlog
from tests.flights import SHIPPED, calm_two

ELEVATOR = Elevator(calibration=((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), lag_s=0.14)
# First and last step of the pilot's command, and the sense of the first, from logs/README.md.
FLOWN = (
    (82.28, 85.08, "up"), (113.34, 116.14, "down"), (136.86, 139.66, "down"), (162.60, 165.40, "up"),
    (188.08, 190.88, "down"), (208.04, 210.84, "up"), (236.32, 239.12, "down"),
)  # fmt: skip


def read(log, aircraft):
    stream = FlightStream(aircraft)
    events = []
    for columns in read_tlog(log):
        events += stream.feed(columns)
    return stream, [e.maneuver for e in events + stream.finish() if isinstance(e, ManeuverFlown)]


@pytest.fixture(scope="module")
def calm():
    return read(SHIPPED / "arduplane-calm.tlog", Aircraft(elevator=ELEVATOR))


def test_all_seven_are_found_within_a_tenth_of_a_second_and_nothing_else(calm):
    _, maneuvers = calm
    assert len(maneuvers) == len(FLOWN)
    for maneuver, (first, last, sense) in zip(maneuvers, FLOWN, strict=True):
        assert maneuver.span.start_s == pytest.approx(first, abs=0.1)
        assert maneuver.span.last_step_s == pytest.approx(last, abs=0.1)
        assert maneuver.span.kind == ("3-2-1-1" if sense == "up" else "reverse 3-2-1-1")
        assert maneuver.mode == "MANUAL"
        # Back in CRUISE four seconds after the last step: its corrections are not part of the record.
        assert maneuver.span.end_s < last + 4.0


def test_the_steps_are_those_of_the_command(calm):
    _, maneuvers = calm
    for maneuver in maneuvers:
        onsets = [onset for onset, _ in maneuver.span.steps]
        levels = [abs(np.degrees(level)) for _, level in maneuver.span.steps[:-1]]
        assert np.diff(onsets) == pytest.approx([1.2, 0.8, 0.4, 0.4], abs=0.05)
        assert levels == pytest.approx([1.08] * 4, abs=0.1)


def test_nose_up_is_positive_and_the_elevator_trailing_edge_down(calm):
    _, maneuvers = calm
    first = maneuvers[0]
    start = first.span.start_s
    pulled = first.channels["elevator"].cut(start + 0.1, start + 0.9).y.mean()
    trim = first.channels["elevator"].cut(start - 0.9, start - 0.1).y.mean()
    assert pulled < trim
    assert first.channels["q"].cut(start + 0.1, start + 0.6).y.mean() > 0.05
    assert first.channels["a_z"].cut(start - 0.9, start).y.mean() == pytest.approx(-9.8, abs=0.5)


def test_the_default_scale_of_the_servos_has_the_same_sign(calm):
    _, maneuvers = calm
    stream, uncalibrated = read(calm_two(), Aircraft())
    assert not stream.elevator.calibrated
    assert [m.span.kind for m in uncalibrated] == [m.span.kind for m in maneuvers[:2]]


def test_the_log_at_default_rates_is_refused_by_message_and_rate():
    stream, _ = read(SHIPPED / "arduplane-default-rates.tlog", Aircraft(elevator=ELEVATOR))
    problems = stream.problems()
    assert {p.code for p in problems} == {"rate"}
    assert any("SERVO_OUTPUT_RAW arrives at 2.0 Hz" in p.text for p in problems)
    assert any("SR0_EXTRA1" in p.fix for p in problems)


def test_in_turbulence_a_movement_without_a_level_of_its_own_is_no_lateral_input():
    stream = FlightStream(Aircraft(elevator=ELEVATOR), lateral=True)
    events = [
        event for columns in read_tlog(SHIPPED / "arduplane-turbulent.tlog") for event in stream.feed(columns)
    ]
    events += stream.finish()
    inputs = [e.maneuver.span for e in events if isinstance(e, SideManeuverFlown)]
    assert all(any(level != 0.0 for _, level in span.steps) for span in inputs)
