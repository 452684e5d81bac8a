"""The written script in ArduPlane itself: inputs as asked, aborts, and the marks that are read."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.log_series import LogSeries
from advisor.flight.maneuvers.events import ManeuverFlown, SideManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.stream.stream import FlightStream
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.table import Source, script_table
from tests.scripts.sitl import SITL, Pilot, airborne

pytestmark = [
    pytest.mark.skipif(
        not (SITL / "arduplane.xz").exists(), reason="no ArduPlane beside the checkout (../shared/sitl)"
    ),
    pytest.mark.timeout(300),
    pytest.mark.xdist_group("arduplane"),
]
TABLE = script_table(
    Aircraft(), Source(), ("3-2-1-1", "aileron doublet", "multisine", "rudder doublet", "reverse 3-2-1-1")
)
US_A_DEG = 400.0 / 25.0
FRAME_S = 0.02
"""Interval of SERVO_OUTPUT_RAW, s, by which telemetry shows a step late."""
ELEVATOR, AILERON, RUDDER = 1, 0, 3


def _abort_by_switch(pilot: Pilot) -> None:
    pilot.sticks[6] = 1000


def _abort_by_stick(pilot: Pilot) -> None:
    pilot.sticks[0] = 1600


def _abort_by_mode(pilot: Pilot) -> None:
    pilot.link.set_mode("FBWB")


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> tuple[Pilot, Path]:
    """Fly two inputs to their ends and abort three: by switch, by stick, by mode."""
    folder = tmp_path_factory.mktemp("arduplane")
    with airborne(ardupilot_script(TABLE), folder) as pilot:
        for number, abort in enumerate((None, None, _abort_by_switch, _abort_by_stick, _abort_by_mode), 1):
            pilot.sticks[6] = 1900
            assert pilot.fly(12.0, pilot.heard(f"ADVISOR BEGIN {number} ")), pilot.texts[-3:]
            if abort is not None:
                pilot.fly(0.4)
                abort(pilot)
            assert pilot.fly(15.0, pilot.heard(f"ADVISOR END {number} ")), pilot.texts[-3:]
            pilot.sticks[0], pilot.sticks[6] = 1500, 1000
            pilot.link.set_mode("FBWA")
            pilot.fly(3.0)
    return pilot, folder / "flight.tlog"


def _on_time(pilot: Pilot, number: int) -> None:
    late = [
        text for _, text in pilot.texts if text.startswith("ADVISOR LATE") and text.endswith(f" {number}")
    ]
    if late:
        pytest.skip(f"this machine is too slow for exact times: {late[0]}")


@pytest.mark.parametrize(("number", "output", "sign"), [(1, ELEVATOR, -1.0), (2, AILERON, -1.0)])
def test_the_steps_are_flown_as_asked(
    number: int, output: int, sign: float, flight: tuple[Pilot, Path]
) -> None:
    pilot, _ = flight
    _on_time(pilot, number)
    entry = TABLE.entries[number - 1]
    (control,) = entry.test.moved
    t, us = pilot.pulses()
    size_us = np.degrees(entry.sizes[control].rad) * US_A_DEG
    flown = us[:, output]
    first = sign * entry.test.steps[0][1] * size_us
    begin = pilot.at(f"ADVISOR BEGIN {number} ")
    near = np.flatnonzero((t > begin - 0.2) & (t < begin + 0.2))
    jumped = near[np.argmax(np.abs(np.diff(flown[near])))]
    onset, trim = t[jumped + 1], flown[jumped + 1] - first
    for units, share in entry.test.steps:
        end = onset + units * entry.test.unit_s
        held = (t >= onset + 0.02 + FRAME_S) & (t <= end - 0.02)
        assert flown[held] == pytest.approx(trim + sign * share * size_us, abs=0.03 * size_us + 1.0)
        onset = end


def test_the_marks_are_those_of_the_flight(flight: tuple[Pilot, Path]) -> None:
    pilot, _ = flight
    marks = [text for _, text in pilot.texts if text.startswith(("ADVISOR BEGIN", "ADVISOR END"))]
    assert marks == [
        "ADVISOR BEGIN 1 3-2-1-1", "ADVISOR END 1 done",
        "ADVISOR BEGIN 2 aileron doublet", "ADVISOR END 2 done",
        "ADVISOR BEGIN 3 multisine", "ADVISOR END 3 aborted: switch",
        "ADVISOR BEGIN 4 rudder doublet", "ADVISOR END 4 aborted: stick",
        "ADVISOR BEGIN 5 reverse 3-2-1-1", "ADVISOR END 5 aborted: mode changed",
    ]  # fmt: skip


@pytest.mark.parametrize(("number", "output"), [(3, ELEVATOR), (4, RUDDER), (5, ELEVATOR)])
def test_an_aborted_surface_is_the_autopilots_within_a_tenth_of_a_second(
    number: int, output: int, flight: tuple[Pilot, Path]
) -> None:
    pilot, _ = flight
    t, us = pilot.pulses()
    end = pilot.at(f"ADVISOR END {number} ")
    after = us[(t > end + 0.1) & (t < end + 1.5), output]
    # The loop moves its surfaces all the time; a held one would rest at one pulse.
    assert len(np.unique(after)) > 3


@pytest.fixture(scope="module")
def maneuvers(flight: tuple[Pilot, Path]) -> list[Maneuver]:
    """Return all manoeuvres that the advisor finds on any axis."""
    _, tlog = flight
    stream = FlightStream(Aircraft(), lateral=True)
    events = [event for batch in LogSeries([tlog]).batches() for event in stream.feed(batch)]
    events += stream.finish()
    return [e.maneuver for e in events if isinstance(e, (ManeuverFlown, SideManeuverFlown))]


def test_the_advisor_finds_the_inputs_that_were_flown_to_their_ends_and_no_other(
    flight: tuple[Pilot, Path], maneuvers: list[Maneuver]
) -> None:
    pilot, _ = flight
    assert [one.span.kind for one in maneuvers] == ["3-2-1-1", "aileron doublet"]
    for number, one in enumerate(maneuvers, 1):
        begin, end = pilot.at(f"ADVISOR BEGIN {number} "), pilot.at(f"ADVISOR END {number} ")
        assert begin - FRAME_S <= one.span.start_s < one.span.last_step_s <= end + FRAME_S


@pytest.mark.parametrize("number", [1, 2])
def test_a_found_input_begins_where_it_was_announced(
    number: int, flight: tuple[Pilot, Path], maneuvers: list[Maneuver]
) -> None:
    pilot, _ = flight
    _on_time(pilot, number)
    begin = pilot.at(f"ADVISOR BEGIN {number} ")
    assert maneuvers[number - 1].span.start_s == pytest.approx(begin, abs=0.15)
