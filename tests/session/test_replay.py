"""A log is played in its order, each message once, whatever is done to the player."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import path_beside, read_by_hand
from advisor.campaign.state import NOTHING, Remark
from advisor.flight.signals.messages import Columns
from advisor.session.conducting import Tempo, view_before_first
from advisor.session.replay import LogPlayer
from advisor.session.timeline import DataBegin, Goal, Position, Timeline
from tests.tui.stand_ins import columns


def log(count: int = 200, rate_hz: float = 50.0) -> list[Columns]:
    """Two message types taking turns at ``rate_hz`` in all."""
    order = np.arange(count)
    arrival_s = 1.7e9 + order / rate_hz
    even = order % 2 == 0
    return [
        columns(order[even], arrival_s[even], "ATTITUDE"),
        columns(order[~even], arrival_s[~even], "AOA_SSA"),
    ]


class Clock:
    """Counts the waits of a player instead of waiting."""

    def __init__(self) -> None:
        self.waited_s = 0.0

    def wait(self, changed: Event, seconds: float) -> None:
        self.waited_s += seconds


def indices(batch: Sequence[Columns]) -> list[int]:
    return sorted(int(k) for piece in batch for k in piece.fields["index"])


def played(player: LogPlayer) -> list[int]:
    """Play to the end; the arrival indices in the order of their delivery."""
    heard: list[int] = []
    while (batch := player.read(0.01)) is not None:
        heard += indices(batch)
    return heard


def test_every_message_is_delivered_once_and_in_order():
    assert played(LogPlayer("x", log, inf, Clock().wait)) == list(range(200))


def test_real_time_is_as_long_as_the_flight():
    clock = Clock()
    played(LogPlayer("x", log, 1.0, clock.wait))
    assert abs(clock.waited_s - 199 / 50.0) <= 0.1


def test_double_speed_takes_half_as_long():
    clock = Clock()
    played(LogPlayer("x", log, 2.0, clock.wait))
    assert abs(clock.waited_s - 199 / 100.0) <= 0.1


def test_a_paused_player_delivers_nothing_until_stepped():
    player = LogPlayer("x", log, 1.0, Clock().wait)
    player.play(Tempo(paused=True))
    assert not player.read(0.01)
    player.step()
    assert indices(player.read(0.01) or ()) == list(range(6))
    assert not player.read(0.01)


def test_a_hurrying_player_waits_for_nothing_and_then_keeps_its_tempo():
    clock = Clock()
    player = LogPlayer("x", log, 1.0, clock.wait)
    player.play(Tempo(paused=True))
    player.hurry(True)
    assert indices(player.read(0.01) or ()) == list(range(26))
    assert clock.waited_s == 0.0
    player.hurry(False)
    assert not player.read(0.01)


def test_a_rewound_player_begins_again():
    player = LogPlayer("x", log, inf, Clock().wait)
    first = played(player)
    player.rewind()
    assert played(player) == first


def test_an_empty_log_ends_at_once():
    assert LogPlayer("x", list).read(0.01) is None


def test_health_tells_reading_from_playing_from_the_end():
    player = LogPlayer("x", log, inf, Clock().wait)
    conditions = [player.health().condition]
    player.read(0.01)
    conditions.append(player.health().condition)
    played(player)
    assert [*conditions, player.health().condition] == ["waiting", "good", "ended"]


def test_a_leaping_clock_is_played_in_bounded_time():
    arrival_s = np.array([0.0, 1.0, 4e9, 4e9 + 1.0, 5.0, 6.0])
    timeline = Timeline([columns(range(6), arrival_s)])
    assert timeline.duration_s == 1.0 + 2.0 + 1.0 + 0.0 + 1.0  # a longer silence lasts 2 s
    assert indices(timeline.up_to(timeline.duration_s)) == list(range(6))


@settings(max_examples=50)
@given(
    st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40),
    st.lists(st.floats(0.0, 100.0), max_size=10),
    st.integers(1, 3),
)
def test_cuts_anywhere_deliver_each_message_once_in_order(arrival_s, positions, kinds):
    order = np.arange(len(arrival_s)) * 7
    stamps = np.array(arrival_s)
    pieces = [columns(order[k::kinds], stamps[k::kinds], f"KIND_{k}") for k in range(kinds)]
    timeline = Timeline(pieces)
    heard: list[int] = []
    for position in [*sorted(positions), timeline.duration_s]:
        heard += indices(timeline.up_to(position))
    assert heard == order.tolist()


def two_logs() -> list[Columns]:
    return [*log(), *(replace(piece, flight=1) for piece in log(100))]


def test_the_timeline_goes_through_all_logs_one_after_the_other():
    timeline = Timeline(two_logs())
    heard: list[tuple[int, int]] = []
    for position_s in np.arange(0.0, timeline.duration_s + 1.0, 0.1):
        batch = timeline.up_to(position_s)
        heard += sorted((piece.flight, k) for piece in batch for k in indices([piece]))
    assert heard == [*((0, k) for k in range(200)), *((1, k) for k in range(100))]


def test_each_decision_is_kept_beside_the_log_that_it_concerns(tmp_path: Path):
    logs = [tmp_path / "first.tlog", tmp_path / "second.tlog"]
    player = LogPlayer("x", two_logs, keep_beside=logs)
    decided = NOTHING.remarking(Remark(5.0, "flaps", flight=1))
    assert "second.maneuvers.yaml" in player.keep(decided)
    assert [remark.text for remark in read_by_hand(logs[1]).remarks] == ["flaps"]
    assert not path_beside(logs[0]).exists()
    player.keep(NOTHING)
    assert read_by_hand(logs[1]).remarks == ()


def test_what_is_said_of_the_logs_is_told_once_they_are_loaded():
    player = LogPlayer("x", two_logs, said=lambda: ["in another order"])
    assert player.take_notices() == ()
    player.read(0.01)
    assert player.take_notices() == ["in another order"]
    assert player.take_notices() == ()


STATE = view_before_first(Aircraft(), "x", None).state


@pytest.mark.parametrize(("flight", "boot"), [(0, 0), (1, 0)])
def test_a_later_time_of_an_earlier_flight_or_power_on_is_not_the_goal(flight: int, boot: int) -> None:
    goal = Goal(1, (1, 1, 50.0))
    assert not goal.reached(replace(STATE, flight=flight, boot=boot, now_s=300.0))
    assert goal.reached(replace(STATE, flight=1, boot=1, now_s=49.5))


def test_a_replay_begins_where_the_data_can_serve() -> None:
    assert not DataBegin().reached(replace(STATE, serves=False))
    assert DataBegin().reached(replace(STATE, serves=True))


def test_a_position_is_reached_when_the_replay_stands_there_or_beyond() -> None:
    assert not Position(30.0).reached(STATE, 29.9)
    assert Position(30.0).reached(STATE, 30.2)
