"""The written script in ArduPlane itself: inputs as asked, aborts, and the marks that are read."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown, SideManeuverFlown
from advisor.flight.stream.stream import FlightStream
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.table import FlightLimits, Source, script_table
from benchmarks.scripted.flight import ScriptFlight, fly_table, level
from benchmarks.scripted.measured import TELEMETRY_MS, deflections, flown_of
from benchmarks.scripted.pilot import SITL, SlowMachineError, airborne

pytestmark = [
    pytest.mark.skipif(
        not (SITL / "arduplane.xz").exists(), reason="no ArduPlane beside the checkout (../shared/sitl)"
    ),
    pytest.mark.timeout(300),
    pytest.mark.xdist_group("arduplane"),
]
NAMES = ("3-2-1-1", "aileron doublet", "multisine", "rudder doublet", "reverse 3-2-1-1")
TABLE = script_table(Aircraft(), Source(), NAMES, limits=FlightLimits.of(Aircraft(), 55.0))
COMPLETE = 2
"""Number of inputs that are flown to their ends."""
FRAME_S = 0.02
"""Interval of ATTITUDE, s, by which the time of a text is known."""
OUTPUTS = {"elevator": 1, "aileron": 0, "rudder": 3}


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> ScriptFlight:
    """Fly two inputs to their ends, and abort four: by switch, by stick, by mode, by height."""
    try:
        return fly_table(TABLE, tmp_path_factory.mktemp("arduplane"), complete=COMPLETE)
    except SlowMachineError as slow:
        pytest.skip(str(slow))


def _on_time(flight: ScriptFlight, number: int) -> None:
    texts = [text for _, text in flight.pilot.texts if text.startswith("ADVISOR LATE")]
    late = [text for text in texts if text.endswith(f" in {number}")]
    if late:
        pytest.skip(f"this machine is too slow for exact times: {late[0]}")


@pytest.mark.parametrize("number", [1, 2])
def test_the_steps_are_flown_as_asked(number: int, flight: ScriptFlight) -> None:
    _on_time(flight, number)
    t, read = deflections(flight.pilot, Aircraft())
    begin_s = flight.pilot.at(f"ADVISOR BEGIN {number} ")
    (flown,) = flown_of(TABLE.entries[number - 1], begin_s, t, read)
    assert flown.late_ms <= 20.0 + TELEMETRY_MS
    assert flown.size_percent <= max(3.0, flown.pulse_percent)


def test_the_marks_are_those_of_the_flight(flight: ScriptFlight) -> None:
    marks = [text for _, text in flight.pilot.texts if text.startswith(("ADVISOR BEGIN", "ADVISOR END"))]
    lowest = marks.pop()
    assert marks == [
        "ADVISOR BEGIN 1 3-2-1-1", "ADVISOR END 1 done",
        "ADVISOR BEGIN 2 aileron doublet", "ADVISOR END 2 done",
        "ADVISOR BEGIN 3 multisine", "ADVISOR END 3 aborted: switch",
        "ADVISOR BEGIN 4 rudder doublet", "ADVISOR END 4 aborted: stick",
        "ADVISOR BEGIN 5 reverse 3-2-1-1", "ADVISOR END 5 aborted: mode changed",
        "ADVISOR BEGIN 6 3-2-1-1",
    ]  # fmt: skip
    assert lowest in ("ADVISOR END 6 aborted: height 55 m", "ADVISOR END 6 aborted: height 54 m")


@pytest.mark.parametrize("why", ["switch", "stick", "mode", "height"])
def test_an_event_ends_the_input_within_a_tenth_of_a_second(why: str, flight: ScriptFlight) -> None:
    ended = flight.aborts[why]
    _on_time(flight, ended.number)
    assert ended.end_s - ended.event_s <= 0.1 + FRAME_S


@pytest.mark.parametrize(
    ("why", "control"), [("switch", "elevator"), ("stick", "rudder"), ("mode", "elevator")]
)
def test_the_surfaces_are_the_autopilots_after_an_abort(why: str, control: str, flight: ScriptFlight) -> None:
    t, us = flight.pilot.pulses()
    end_s = flight.aborts[why].end_s
    after = us[(t > end_s + 0.1) & (t < end_s + 1.5), OUTPUTS[control]]
    # The loop moves its surfaces all the time; a held one would rest at one pulse.
    assert len(np.unique(after)) > 3


@pytest.fixture(scope="module")
def maneuvers(flight: ScriptFlight) -> list[Maneuver]:
    """Return all manoeuvres that the advisor finds on any axis."""
    stream = FlightStream(Aircraft(), lateral=True)
    events = [event for batch in LogSeries([flight.tlog]).batches() for event in stream.feed(batch)]
    events += stream.finish()
    return [e.maneuver for e in events if isinstance(e, (ManeuverFlown, SideManeuverFlown))]


def test_the_advisor_finds_the_inputs_that_were_flown_to_their_ends_and_no_other(flight, maneuvers):
    pilot = flight.pilot
    assert [one.span.kind for one in maneuvers] == ["3-2-1-1", "aileron doublet"]
    for number, one in enumerate(maneuvers, 1):
        begin_s, end_s = pilot.at(f"ADVISOR BEGIN {number} "), pilot.at(f"ADVISOR END {number} ")
        assert begin_s - FRAME_S <= one.span.start_s < one.span.last_step_s <= end_s + FRAME_S


@pytest.mark.parametrize("number", [1, 2])
def test_a_found_input_begins_where_it_was_announced(number, flight, maneuvers):
    _on_time(flight, number)
    begin_s = flight.pilot.at(f"ADVISOR BEGIN {number} ")
    assert maneuvers[number - 1].span.start_s == pytest.approx(begin_s, abs=0.15)


@pytest.mark.study
def test_a_script_in_manual_flies_its_input_and_leaves_the_mode(tmp_path: Path) -> None:
    try:
        with airborne(ardupilot_script(TABLE), tmp_path) as pilot:
            flight = ScriptFlight(pilot, TABLE, tmp_path / "flight.tlog")
            level(pilot, "MANUAL")
            flight.begun(1)
            flight.over(1)
            pilot.fly(2.0)
    except SlowMachineError as slow:
        pytest.skip(str(slow))
    assert pilot.said("ADVISOR END 1 ") == "ADVISOR END 1 done"
    assert pilot.link.flightmode == "MANUAL"
