"""A script's texts mark its inputs without a word in the aircraft file; a text without a partner is told."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.elevator.elevator_guess import turned
from advisor.flight.maneuvers.maneuver import Activity, Maneuver, Notice, SideManeuverFlown, Span
from advisor.flight.maneuvers.markers import marked_span
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.record import Channel
from advisor.flight.stream.stream import FlightStream
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.table import Source, script_table
from tests.flight.columns import Wire, attitude, fly, heartbeat, plane_parameters, pull, servo, text
from tests.flight.maneuvers.test_marks import PIECE
from tests.flight.stream.test_stream import as_plain, flown, maneuvers
from tests.rows import row
from tests.scripts.engine import Engine

BEGIN, END = "ADVISOR BEGIN 3 reverse 3-2-1-1", "ADVISOR END 3 done"
SCRIPT = "ADVISOR SCRIPT my aircraft 1a2b3c4d"


def announced(*texts: tuple[float, str], seconds: float = 14.0, mode: int = 0) -> Wire:
    """A flight from 50 s since boot on, a 3-2-1-1 from 54.0 to 56.8 s, and texts at times since boot."""
    wire = Wire()
    fly(wire, 1000.0, 50.0, [4.0], seconds, mode=mode)
    for at_s, said in texts:
        text(wire, 950.0 + at_s, said)
    return wire


def told(wire: Wire, aircraft: Aircraft | None = None) -> list[str]:
    _, events = flown(wire, aircraft or Aircraft())
    return [event.text for event in events if isinstance(event, Notice) and event.code == "script_mark"]


def listed(wire: Wire) -> list[Activity]:
    _, events = flown(wire)
    return [event for event in events if isinstance(event, Activity)]


def test_begin_and_end_mark_a_manoeuvre_and_its_free_response():
    _, events = flown(announced((53.0, BEGIN), (57.0, END)))
    (maneuver,) = maneuvers(events)
    assert maneuver.span.closed_by == "marked by a script"
    assert maneuver.span.start_s == pytest.approx(54.0, abs=0.05)
    assert maneuver.span.end_s == pytest.approx(60.0, abs=0.05)


@row("a script that rests before its end ends the record there", [(60.5, END)], 60.5)
@row("an announced input ends the free response", [(57.0, END), (58.5, "ADVISOR BEGIN 4 doublet")], 58.5)
def test_the_record_of_an_announced_input_ends(texts, end_s: float):
    _, events = flown(announced((53.0, BEGIN), *texts))
    (maneuver,) = maneuvers(events)
    assert maneuver.span.end_s == pytest.approx(end_s, abs=0.05)


@pytest.mark.parametrize(("by", "ends_s"), [("script", 20.0), ("text", 23.0)])
def test_a_scripts_rest_counts_also_at_another_level_than_the_loop_held_before(by: str, ends_s: float):
    t = np.arange(8.0, 24.0, 0.02)
    y = np.where(t < 10.0, 0.15, 0.0) + np.where((t > 10.0) & (t < 12.0), 0.1 * np.sign(np.sin(6.0 * t)), 0.0)
    y = y + np.where(t > 20.0, 0.05 * np.sin(5.0 * t), 0.0)
    mark = Mark(10.0, 20.0, by=by, free_s=3.0)
    assert marked_span(mark, Channel("elevator", t, y)).end_s == pytest.approx(ends_s)


@row("the announced name is that of the input", "reverse 3-2-1-1", "reverse 3-2-1-1")
@row("an unknown name leaves the input its own", "a wobble", "3-2-1-1")
@row("no name leaves the input its own", "", "3-2-1-1")
@row("a name of the rudder leaves the input its own", "rudder doublet", "3-2-1-1")
def test_an_announced_input_is_called(name: str, kind: str):
    _, events = flown(announced((53.0, f"ADVISOR BEGIN 3 {name}"), (57.0, END)))
    assert [m.span.kind for m in maneuvers(events)] == [kind]


MARKED = "marked by a script"


@row("an announced input in a closed pitch loop counts", [(53.0, BEGIN), (57.0, END)], 5, MARKED)
@row("an input that is enough is judged", [(53.0, BEGIN), (57.0, "ADVISOR END 3 done: enough")], 0, MARKED)
@row("steps by hand in manual count beside a script", [(50.5, SCRIPT)], 0, "quiet")
@row("steps in a loop without their END are judged", [(50.5, SCRIPT), (53.5, BEGIN)], 5, "quiet")
@row("steps in a loop without their BEGIN are judged", [(50.5, SCRIPT), (57.0, END)], 5, "quiet")
@row("a script heard after the movement changes nothing", [(63.5, SCRIPT)], 5, "quiet")
def test_the_texts_and_the_mode_decide_what_ends_the_input(texts, mode: int, closed_by: str):
    _, events = flown(announced(*texts, mode=mode))
    assert [m.span.closed_by for m in maneuvers(events)] == [closed_by]


def test_an_aborted_input_is_listed_with_its_reason_and_not_judged():
    wire = announced((53.0, BEGIN), (56.0, "ADVISOR END 3 aborted: the stick moved by 12 %"))
    _, events = flown(wire)
    assert maneuvers(events) == []
    (activity,) = listed(wire)
    assert activity.reason == "aborted"
    assert activity.text == (
        "input 3 (reverse 3-2-1-1) was ended early by the script: the stick moved by 12 %; not judged"
    )
    assert (activity.start_s, activity.end_s) == pytest.approx((53.0, 56.0), abs=0.05)


def test_an_early_end_in_two_chunks_is_read_whole():
    wire = announced()
    why = "ADVISOR END 3 aborted: the height above the ground fell below 60 m"
    for at_s, number, chunk, part in ((3.0, 0, 0, BEGIN), (6.0, 7, 0, why[:50]), (6.001, 7, 1, why[50:])):
        wire.send("STATUSTEXT", 1000.0 + at_s, severity=5, text=part.encode(), id=number, chunk_seq=chunk)
    (activity,) = listed(wire)
    assert "the height above the ground fell below 60 m; not judged" in activity.text


def test_a_switch_that_bounces_is_listed():
    wire = announced((53.0, BEGIN), (53.2, "ADVISOR END 3 aborted: switch"))
    (activity,) = listed(wire)
    assert activity.reason == "bounce"
    assert "input 3 (reverse 3-2-1-1) ended after 0.20 s (a test lasts at least 0.5 s)" in activity.text


def test_an_input_that_another_abort_ends_quickly_is_no_bounce():
    (activity,) = listed(announced((53.0, BEGIN), (53.2, "ADVISOR END 3 aborted: stick")))
    assert activity.reason == "aborted"


def test_steps_that_the_script_does_not_announce_are_the_loops():
    wire = announced((50.5, SCRIPT), mode=5)
    _, events = flown(wire)
    assert maneuvers(events) == []
    (activity,) = listed(wire)
    assert (activity.reason, activity.text) == (
        "autopilot",
        "the elevator moved in FBWA, and the script in the autopilot announced no input; not a test input",
    )


def test_a_begin_without_an_end_is_told_and_hides_nothing():
    wire = announced((53.0, BEGIN))
    (sentence,) = told(wire)
    assert sentence == (
        "ADVISOR BEGIN at 0:53.0, input 3 (reverse 3-2-1-1), has no END before the end of the messages, so "
        "it marks nothing; mark the stretch by hand if it was flown."
    )
    _, events = flown(wire)
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]


def test_a_begin_that_stays_open_for_longer_than_any_mark_is_told_in_flight():
    wire = announced((53.0, BEGIN), seconds=120.0)
    stream = FlightStream(Aircraft())
    events = stream.feed(wire.columns())
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]
    (sentence,) = [e.text for e in events if isinstance(e, Notice) and e.code == "script_mark"]
    assert "has no END within 100 s" in sentence


def test_of_two_begins_the_second_counts_and_the_first_is_told():
    wire = announced((50.5, "ADVISOR BEGIN 2 doublet"), (53.0, BEGIN), (57.0, END))
    _, events = flown(wire)
    assert [m.span.kind for m in maneuvers(events)] == ["reverse 3-2-1-1"]
    (sentence,) = told(wire)
    assert "input 2 (doublet), has no END before BEGIN 3 at 0:53.0" in sentence


def test_an_end_without_a_begin_is_told_and_marks_nothing():
    wire = announced((57.0, END))
    assert told(wire) == [
        "ADVISOR END 3 at 0:57.0 has no BEGIN, so it marks nothing; mark the stretch by hand if it was flown."
    ]
    _, events = flown(wire)
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]


def test_the_end_of_another_number_ends_no_input():
    first, second = told(announced((53.0, BEGIN), (57.0, "ADVISOR END 4 done")))
    assert "input 3 (reverse 3-2-1-1), has no END before ADVISOR END 4 at 0:57.0" in first
    assert second.startswith("ADVISOR END 4 at 0:57.0 has no BEGIN")


def test_a_text_that_arrives_twice_counts_once():
    wire = announced((53.0, BEGIN), (53.1, BEGIN), (57.0, END), (57.1, END))
    assert told(wire) == []
    _, events = flown(wire)
    assert len(maneuvers(events)) == 1


def test_a_text_without_a_number_is_told_with_the_known_ones():
    (sentence,) = told(announced((53.0, "ADVISOR BEGIN doublet")))
    assert sentence.startswith("The text ADVISOR BEGIN doublet is no mark")


@row("further texts are no marks", [(53.0, "ADVISOR WAITS: bank"), (54.0, "ADVISOR NEXT 3 doublet")])
@row("without an aircraft file any script is taken", [(51.0, "ADVISOR SCRIPT big wing 1a2b3c4d")])
def test_nothing_is_said_of_texts_of_a_script(texts):
    assert told(announced(*texts)) == []


def test_a_script_of_another_aircraft_is_told_with_both_names():
    wire = announced((51.0, "ADVISOR SCRIPT big wing 1a2b3c4d"))
    (sentence,) = told(wire, Aircraft(name="small wing"))
    assert sentence == (
        "The script in the autopilot was written for the aircraft big wing, and the aircraft file is that of "
        "small wing; write the script anew: advisor script ardupilot."
    )


def said_by(script_of: Aircraft) -> Wire:
    engine = Engine(armed=False)
    engine.load(ardupilot_script(script_table(script_of, Source())))
    (line,) = engine.said("ADVISOR SCRIPT")
    return announced((51.0, line))


@pytest.mark.parametrize("name", ["big wing", "a glider with a very long name", "Flügel 三"])
def test_the_script_of_the_aircraft_file_is_taken(name: str):
    aircraft = Aircraft(name=name)
    assert told(said_by(aircraft), aircraft) == []


@pytest.mark.parametrize("name", [Aircraft.name, "big wing"])
def test_a_script_with_earlier_calibrations_is_told(name: str):
    before, after = (
        Aircraft(name=name, elevator=Elevator(calibration=((1100.0, -deg), (1900.0, deg))))
        for deg in (20.0, 22.0)
    )
    assert told(said_by(before), after) == [
        f"The script in the autopilot was written for other calibrations of {name} than those in the "
        "aircraft file; write the script anew: advisor script ardupilot."
    ]


@pytest.mark.parametrize("begun", [((53.0, BEGIN),), ()], ids=["announced", "not announced"])
def test_announced_inputs_in_flight_are_those_of_a_replay(begun: tuple[tuple[float, str], ...]):
    further = (57.0, END), (58.5, BEGIN), (60.0, "ADVISOR END 3 aborted: mode")
    wire = announced((50.5, SCRIPT), *begun, *further, mode=5)
    stream, live = FlightStream(Aircraft()), []
    for i in range(0, len(wire), PIECE):
        live += stream.feed(wire.columns(range(i, min(i + PIECE, len(wire)))))
    live += stream.finish()
    _, replayed = flown(wire)
    assert as_plain(live) == as_plain(replayed)
    assert len(maneuvers(live)) == 1


@pytest.mark.parametrize(
    ("closed_by", "kind"), [("marked by a script", "3-2-1-1"), ("quiet", "reverse 3-2-1-1")]
)
def test_the_announced_name_stays_where_the_elevator_moves_the_other_way(closed_by: str, kind: str):
    t = np.arange(0.0, 5.0, 0.02)
    span = Span(0.0, 1.0, 3.0, 5.0, "3-2-1-1", ((1.0, 0.1), (3.0, 0.0)), closed_by)
    maneuver = Maneuver(1, 0, span, {"elevator": Channel("elevator", t, 0.1 * t, "SERVO_OUTPUT_RAW")})
    assert turned(maneuver).span.kind == kind


def test_a_stretch_in_which_several_surfaces_move_has_one_extent_on_both_axes():
    wire = Wire()
    heartbeat(wire, 1000.0)
    plane_parameters(wire, 1000.001)
    for k in range(700):
        since_s = k / 50.0
        pulses = {1: 1500 + 20 * pull(since_s - 4.2), 2: 1500 + 20 * pull(since_s - 4.0), 4: 1500}
        attitude(wire, 1000.01 + since_s, 50.0 + since_s)
        servo(wire, 1000.011 + since_s, 50.0 + since_s, pulses)
    text(wire, 1003.0, "ADVISOR BEGIN 1 multisine")
    text(wire, 1008.0, "ADVISOR END 1 done")
    stream = FlightStream(Aircraft(), lateral=True)
    events = stream.feed(wire.columns()) + stream.finish()
    (pitch,) = maneuvers(events)
    (side,) = (event.maneuver for event in events if isinstance(event, SideManeuverFlown))
    assert pitch.span.start_s == side.span.start_s == pytest.approx(54.0, abs=0.05)
    assert pitch.span.end_s == side.span.end_s == pytest.approx(61.0, abs=0.05)
    assert pitch.span.kind == side.span.kind == "multisine"


def _in_a_loop(moved: tuple[int, ...], name: str = "multisine") -> tuple[list[Span], list[Span]]:
    """Spans of an announced input in FBWA, after whose END the loop moves aileron and rudder."""
    wire = Wire()
    heartbeat(wire, 1000.0, mode=5)
    plane_parameters(wire, 1000.001)
    for k in range(800):
        since_s = k / 50.0
        pulses = {n: 1500 + (20 * pull(since_s - 4.0) if n in moved else 0) for n in (1, 2, 4)}
        if since_s < 3.9 and 4 not in moved:
            pulses[4] = 1503
        if since_s > 9.0:
            pulses |= {1: 1650, 4: 1600}
        attitude(wire, 1000.01 + since_s, 50.0 + since_s)
        servo(wire, 1000.011 + since_s, 50.0 + since_s, pulses)
    text(wire, 1003.9, f"ADVISOR BEGIN 1 {name}")
    text(wire, 1009.0, "ADVISOR END 1 done")
    stream = FlightStream(Aircraft(), lateral=True)
    events = stream.feed(wire.columns()) + stream.finish()
    return [one.span for one in maneuvers(events)], [
        e.maneuver.span for e in events if isinstance(e, SideManeuverFlown)
    ]


def test_the_loop_that_moves_a_surface_after_the_end_is_no_part_of_the_input():
    (pitch,), (side,) = _in_a_loop((1, 2, 4))
    for span in (pitch, side):
        assert span.start_s == pytest.approx(54.0, abs=0.05)
        assert span.last_step_s < 58.0
        assert span.end_s == pytest.approx(59.0, abs=0.05)


def test_a_surface_that_the_script_holds_is_no_part_of_the_input():
    (pitch,), sides = _in_a_loop((2,))
    assert (pitch.start_s, pitch.end_s) == pytest.approx((54.0, 62.0), abs=0.05)
    assert sides == []


@row("an elevator in an aileron doublet is no test", "aileron doublet", [], ["aileron doublet"])
@row("an aileron in a 3-2-1-1 is no test", "3-2-1-1", ["3-2-1-1"], [])
def test_the_loop_moves_another_control_in_an_announced_input(name: str, pitch: list[str], side: list[str]):
    pitching, rolling = _in_a_loop((1, 2), name)
    assert ([one.kind for one in pitching], [one.kind for one in rolling]) == (pitch, side)
