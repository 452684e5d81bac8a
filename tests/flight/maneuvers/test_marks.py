"""A marked stretch is a manoeuvre: whoever marks it, and however messages arrive."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from advisor.aircraft.aircraft import Aircraft, Markers
from advisor.flight.maneuvers.maneuver import Activity, Notice
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, attitude, fly, heartbeat, hud, plane_parameters, servo, switch, text
from tests.flight.stream.test_stream import ONE, as_plain, flown, maneuvers

PIECE = 36
"""Messages that arrive together in a flight that is followed, 0.18 s of it."""
BY_SWITCH = Aircraft(markers=Markers(rc=9))


def one_input(seconds: float = 14.0) -> Wire:
    """A flight from 50 s since boot on, with a 3-2-1-1 from 54.0 to 56.8 s."""
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, seconds)
    return wire


def marked(*marks: Mark, wire: Wire | None = None):
    _, events = flown(wire or one_input(), marks=marks)
    return maneuvers(events)


def test_a_marked_stretch_takes_the_place_of_what_the_finder_finds_in_it():
    (maneuver,) = marked(Mark(53.0, 58.5))
    assert maneuver.span.closed_by == "marked by hand"
    assert maneuver.span.end_s == 58.5
    assert maneuver.channels["q"].t[-1] <= 58.5


def test_its_record_begins_a_second_before_the_mark():
    (maneuver,) = marked(Mark(53.0, 58.5))
    assert maneuver.span.record_from_s == pytest.approx(52.0, abs=0.03)
    assert maneuver.channels["elevator"].t[0] == maneuver.span.record_from_s


def test_its_record_begins_with_the_data_where_they_begin_later():
    (maneuver,) = marked(Mark(50.2, 58.5))
    assert maneuver.span.record_from_s == pytest.approx(50.0, abs=0.03)


def test_the_input_in_it_has_its_name_and_its_steps():
    (found,) = marked()
    (maneuver,) = marked(Mark(53.0, 58.5))
    assert maneuver.span.kind == found.span.kind == "3-2-1-1"
    assert maneuver.span.steps == found.span.steps
    assert maneuver.span.last_step_s == found.span.last_step_s


def test_a_mark_that_begins_within_an_input_has_no_name():
    (maneuver,) = marked(Mark(55.5, 60.0))
    assert maneuver.span.kind == "other"
    assert maneuver.span.start_s == pytest.approx(56.0, abs=0.05)
    assert maneuver.span.last_step_s == pytest.approx(56.8, abs=0.05)


def test_several_inputs_in_one_mark_are_one_manoeuvre_without_a_name():
    wire = Wire()
    fly(wire, 1000.0, 50.0, [4.0, 14.0], 24.0)
    (maneuver,) = marked(Mark(53.0, 70.0), wire=wire)
    assert maneuver.span.kind == "other"


def test_what_no_mark_touches_is_found_as_before():
    wire = Wire()
    fly(wire, 1000.0, 50.0, [4.0, 14.0], 24.0)
    first, second = marked(Mark(63.0, 69.0), wire=wire)
    assert (first.span.closed_by, second.span.closed_by) == ("quiet", "marked by hand")
    assert (first.number, second.number) == (1, 2)


def test_a_mark_after_an_input_ends_its_free_response_and_hides_nothing():
    first, second = marked(Mark(58.5, 61.0))
    assert first.span.kind == "3-2-1-1"
    assert first.span.end_s == second.span.start_s == 58.5
    assert second.span.closed_by == "marked by hand"


def test_a_stretch_in_which_nothing_was_found_is_a_manoeuvre_when_it_is_marked():
    first, second = marked(Mark(50.5, 53.0))
    assert (first.span.kind, first.span.steps) == ("other", ())
    assert first.span.last_step_s == first.span.start_s
    assert second.span.kind == "3-2-1-1"


def test_marks_from_the_start_of_the_log_count_from_its_first_sample():
    (maneuver,) = marked(Mark(3.0, 8.5, from_log_start=True))
    assert maneuver.span.end_s == pytest.approx(58.5)


def test_in_a_mode_that_closes_the_pitch_loop_and_on_the_ground_a_mark_counts_too():
    wire = Wire()
    fly(wire, 1000.0, 50.0, [], 14.0, mode=5)
    (maneuver,) = marked(Mark(53.0, 58.5), wire=wire)
    assert maneuver.mode == "FBWA"
    slow = Wire()
    heartbeat(slow, 1000.0)
    plane_parameters(slow, 1000.001)
    for k in range(500):
        attitude(slow, 1000.01 + k / 50, 50.0 + k / 50)
        servo(slow, 1000.011 + k / 50, 50.0 + k / 50, {1: 1500, 2: 1500, 3: 1600, 4: 1500})
        hud(slow, 1000.012 + k / 50, airspeed=1.0)
    assert len(marked(Mark(53.0, 58.5), wire=slow)) == 1


def test_a_mark_belongs_to_the_power_on_that_holds_it():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 12.0)
    fly(wire, 1015.0, 3.0, ONE, 12.0)
    first, second = marked(Mark(6.0, 12.0), wire=wire)
    assert (first.boot, first.span.closed_by) == (0, "quiet")
    assert (second.boot, second.span.closed_by) == (1, "marked by hand")


def test_seconds_from_the_start_of_the_log_run_on_over_a_reboot():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 12.0)
    fly(wire, 1015.0, 3.0, ONE, 12.0)
    _, second = marked(Mark(15.0, 21.0, from_log_start=True), wire=wire)
    assert second.boot == 1
    assert second.span.end_s == pytest.approx(3.0 + 21.0 - 12.0, abs=0.1)


def test_a_mark_outside_of_the_log_is_a_problem_once_the_log_is_over():
    stream = FlightStream(Aircraft(), marks=[Mark(400.0, 420.0, name="--maneuver 400:420")])
    stream.feed(one_input().columns())
    assert stream.problems() == []
    stream.finish()
    (problem,) = stream.problems()
    assert problem.code == "mark_outside"
    assert problem.text.startswith(
        "--maneuver 400:420 lies outside of the log, which holds 0:50.0 to 1:04.0."
    )


def test_a_mark_may_reach_a_moment_beyond_a_recording_and_ends_with_the_data():
    (maneuver,) = marked(Mark(49.0, 65.0))
    assert maneuver.span.closed_by == "marked by hand"
    assert maneuver.span.record_from_s == pytest.approx(50.0, abs=0.03)
    assert maneuver.span.end_s == pytest.approx(64.0, abs=0.03)


def test_marks_may_follow_upon_each_other():
    first, second = marked(Mark(53.0, 58.5), Mark(58.5, 62.0))
    assert (first.span.end_s, second.span.start_s) == (58.5, 58.5)


def test_of_two_marks_that_overlap_the_first_given_counts_and_the_other_is_told():
    _, events = flown(one_input(), marks=[Mark(53.0, 58.5), Mark(3.0, 8.0, from_log_start=True)])
    assert len(maneuvers(events)) == 1
    assert [event.code for event in events if isinstance(event, Notice)][-1] == "marked_already"


def switched(on_s: float, off_s: float, rate_hz: float = 5.0, seconds: float = 14.0) -> Wire:
    """The flight of one input with a switch that is on between two times since boot."""
    wire = one_input(seconds)
    for k in range(int(seconds * rate_hz)):
        boot_s = 50.0 + k / rate_hz
        switch(wire, 1000.013 + k / rate_hz, boot_s, 1900 if on_s <= boot_s < off_s else 1100)
    return wire


def test_a_pilots_switch_marks_from_on_to_off():
    _, events = flown(switched(53.0, 60.0), BY_SWITCH)
    (maneuver,) = maneuvers(events)
    assert maneuver.span.closed_by == "marked by a switch"
    assert maneuver.span.record_from_s == pytest.approx(52.0, abs=0.03)
    assert maneuver.span.end_s == pytest.approx(60.0, abs=0.01)


def test_without_markers_in_the_aircraft_file_no_channel_is_a_switch():
    _, events = flown(switched(53.0, 60.0))
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]


def test_a_switch_that_is_still_on_at_the_end_marks_up_to_the_end():
    _, events = flown(switched(53.0, 99.0), BY_SWITCH)
    (maneuver,) = maneuvers(events)
    assert maneuver.span.end_s == pytest.approx(64.0, abs=0.05)


def test_a_receiver_without_the_channel_switches_nothing():
    wire = one_input()
    switch(wire, 1001.0, 51.0, 65535)
    switch(wire, 1002.0, 52.0, 0)
    _, events = flown(wire, BY_SWITCH)
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]


def test_a_switch_left_on_for_too_long_is_told_and_hides_nothing():
    wire = one_input(120.0)  # a mark lasts 100 s at most
    switch(wire, 1001.0, 51.0, 1900)
    switch(wire, 1110.5, 160.5, 1100)
    _, events = flown(wire, BY_SWITCH)
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]
    assert "at most 100 s" in next(
        e.text for e in events if isinstance(e, Notice) and e.code == "mark_length"
    )


@pytest.mark.parametrize(
    ("aircraft", "begins", "ends", "closed_by"),
    [
        (Aircraft(), "SystemID Starting: axis=21", "SystemID stopped", "marked by SystemID"),
        (
            Aircraft(markers=Markers(text=("MARK", "MARK OFF"))),
            "MARK",
            "MARK OFF",
            "marked by a text of the vehicle",
        ),
    ],
)
def test_texts_of_the_vehicle_mark_a_manoeuvre(aircraft: Aircraft, begins: str, ends: str, closed_by: str):
    wire = one_input()
    text(wire, 1003.0, begins)
    text(wire, 1010.0, ends)
    _, events = flown(wire, aircraft)
    (maneuver,) = maneuvers(events)
    assert maneuver.span.closed_by == closed_by
    assert maneuver.span.end_s == pytest.approx(60.0, abs=0.05)


def test_a_sweep_of_system_id_without_an_effect_of_the_elevator_is_told_and_no_manoeuvre():
    wire = Wire()
    fly(wire, 1000.0, 50.0, [], 14.0)
    text(wire, 1003.0, "SystemID Starting: axis=20")
    text(wire, 1010.0, "SystemID stopped")
    _, events = flown(wire)
    assert maneuvers(events) == []
    (told,) = (event for event in events if isinstance(event, Activity))
    assert told.reason == "small"


def test_texts_of_a_ground_station_mark_nothing():
    wire = one_input()
    text(wire, 1003.0, "SystemID Starting: axis=21", system=255, component=190)
    text(wire, 1010.0, "SystemID stopped", system=255, component=190)
    assert [m.span.closed_by for m in marked(wire=wire)] == ["quiet"]


def by_hand(wire: Wire, begin_s: float, end_s: float, hand: bool = True):
    """In pieces of some 0.2 s, with marks set when the vehicle's clock has come to these times."""
    stream, events, at = FlightStream(BY_SWITCH), [], []
    for i in range(0, len(wire), PIECE):
        events += stream.feed(wire.columns(range(i, min(i + PIECE, len(wire)))))
        now_s = stream.now_s
        if hand and not at and now_s >= begin_s:
            at.append(now_s)
            stream.marks.begin_by_hand(now_s)
        elif hand and len(at) == 1 and now_s >= end_s:
            at.append(now_s)
            assert isinstance(stream.marks.end_by_hand(now_s), Mark)
    return at, events + stream.finish()


@pytest.mark.parametrize(
    ("begin_s", "end_s"), [(53.0, 60.0), (55.0, 57.0), (59.0, 61.0), (59.95, 61.5), (61.0, 63.9)]
)
def test_a_mark_made_in_flight_gives_what_the_same_mark_gives_when_it_is_known_before(begin_s, end_s):
    wire = one_input()
    at, live = by_hand(wire, begin_s, end_s)
    _, replayed = flown(wire, BY_SWITCH, marks=[Mark(at[0], at[1], 0)])
    assert as_plain(live) == as_plain(replayed)
    assert any(m.span.closed_by == "marked by hand" for m in maneuvers(live))


@pytest.mark.parametrize(("on_s", "off_s"), [(54.5, 61.0), (53.0, 57.0)])
def test_a_hand_wins_over_a_switch_in_flight_as_in_a_replay_and_that_is_told(on_s: float, off_s: float):
    wire = switched(on_s, off_s)
    at, live = by_hand(wire, 54.0, 58.0)
    _, replayed = flown(wire, BY_SWITCH, marks=[Mark(at[0], at[1], 0)])
    assert as_plain(live) == as_plain(replayed)
    assert [m.span.closed_by for m in maneuvers(live)] == ["marked by hand"]
    assert any(isinstance(event, Notice) and event.code == "marked_already" for event in live)


def test_a_mark_that_is_begun_anew_gives_back_what_the_first_one_held():
    wire = one_input(20.0)
    stream, events, begun = FlightStream(Aircraft()), [], []
    for i in range(0, len(wire), PIECE):
        events += stream.feed(wire.columns(range(i, min(i + PIECE, len(wire)))))
        for at_s in (55.0, 67.0):
            if stream.now_s >= at_s and at_s not in begun:
                begun.append(at_s)
                stream.marks.begin_by_hand(stream.now_s)
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]


def test_a_mark_that_is_not_ended_before_a_reboot_is_dropped_and_told():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 12.0)
    fly(wire, 1015.0, 3.0, [], 5.0)
    stream = FlightStream(Aircraft())
    events = stream.feed(wire.columns(range(1600)))
    stream.marks.begin_by_hand(stream.now_s)
    events += stream.feed(wire.columns(range(1600, len(wire)))) + stream.finish()
    assert [m.span.closed_by for m in maneuvers(events)] == ["quiet"]
    assert "is dropped" in next(e.text for e in events if isinstance(e, Notice) and e.code == "mark_dropped")


def test_ending_a_mark_that_was_not_begun_says_so():
    refused = FlightStream(Aircraft()).marks.end_by_hand(10.0)
    assert isinstance(refused, Notice)
    assert "begin one first" in refused.text


def test_while_a_mark_is_open_its_stretch_is_what_is_being_flown():
    wire = one_input()
    stream = FlightStream(Aircraft())
    stream.feed(wire.columns(range(len(wire) // 5)))
    since_s = stream.now_s
    stream.marks.begin_by_hand(since_s)
    stream.feed(wire.columns(range(len(wire) // 5, len(wire) // 4)))
    flying = stream.so_far()
    assert flying is not None
    assert flying.span.start_s == since_s


@pytest.fixture(scope="module")
def eventful() -> Wire:
    """A flight with a switch and a sweep that is said in text."""
    wire = switched(53.0, 60.0)
    text(wire, 1011.0, "SystemID Starting: axis=21")
    text(wire, 1013.0, "SystemID stopped")
    return wire


@pytest.fixture(scope="module")
def whole(eventful: Wire) -> list[object]:
    """What is told of that flight where all of it arrives at once."""
    _, events = flown(eventful, BY_SWITCH)
    return events


@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_no_mark_depends_on_how_messages_are_batched(eventful, whole, data):
    n = len(eventful)
    cuts = sorted(data.draw(st.sets(st.integers(1, n - 1), max_size=40)))
    _, cut = flown(eventful, BY_SWITCH, batches=[range(a, b) for a, b in pairwise([0, *cuts, n])])
    # The sweep does not move this aircraft, so that it is an activity.
    assert len(maneuvers(whole)) == sum(isinstance(event, Activity) for event in whole) == 1
    assert as_plain(cut) == as_plain(whole)
