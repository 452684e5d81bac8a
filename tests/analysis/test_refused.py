"""Manoeuvres that analyze refuses are named, and the gap does not use them."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import without_refused
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import InstrumentFinding
from advisor.words.problems import UnusableInputError
from tests.maneuvers import changed
from tests.simulators.nonlinear import flown


def banked(maneuver: Maneuver, deg: float) -> Maneuver:
    t = maneuver.channels["q"].t
    bank = Channel("bank", t, np.full(len(t), np.radians(deg)), "test", "measured")
    return replace(maneuver, channels={**maneuver.channels, "bank": bank})


def with_hole(maneuver: Maneuver, seconds: float) -> Maneuver:
    """Return the manoeuvre without its pitch rate for some seconds after the first step."""
    q, start = maneuver.channels["q"], maneuver.span.start_s
    stays = (q.t < start) | (q.t > start + seconds)
    return changed(maneuver, "q", t=q.t[stays], y=q.y[stays])


def test_a_turn_and_a_hole_in_the_record_are_named_and_not_used():
    first, turn, hole, fourth, fifth = flown(maneuvers=5)
    found = without_refused([first, banked(turn, 43.0), with_hole(hole, 0.8), fourth, fifth], Aircraft())
    assert [m.number for m in found.maneuvers] == [1, 4, 5]
    assert found.although_refused == ()
    assert found.notes[0].startswith("Manoeuvre 2 is not used: bank reached 43 deg (limit 30)")
    assert found.notes[1].startswith("Manoeuvre 3 is not used: 0.8 s of q are missing")


def test_where_too_few_would_remain_all_are_used_and_the_reason_is_said():
    maneuvers = [banked(m, 43.0) for m in flown(maneuvers=3)]
    found = without_refused(maneuvers, Aircraft())
    assert found.maneuvers == maneuvers
    assert found.although_refused == (1, 2, 3)
    assert found.notes[0].startswith("advisor analyze refuses manoeuvre 1: bank reached 43 deg (limit 30)")


def test_two_sound_manoeuvres_are_too_few_and_three_are_enough():
    first, second, third, turn = flown(maneuvers=4)
    turn = banked(turn, 43.0)
    assert len(without_refused([first, second, turn], Aircraft()).maneuvers) == 3
    assert len(without_refused([first, second, third, turn], Aircraft()).maneuvers) == 3


def test_a_throttle_that_moves_is_known_to_the_gaps_model():
    maneuvers = flown(maneuvers=3)
    t = maneuvers[0].channels["q"].t
    moved = Channel("throttle", t, np.where(t > t[100], 0.8, 0.4), "test", "measured")
    maneuvers[0] = replace(maneuvers[0], channels={**maneuvers[0].channels, "throttle": moved})
    assert without_refused(maneuvers, Aircraft()).notes == ()


def broken_off(m: Maneuver) -> Maneuver:
    steps = ((m.span.start_s, 0.05),)
    return replace(m, span=replace(m.span, closed_by="gap", steps=steps))


def slowing(m: Maneuver, percent: float) -> Maneuver:
    """Return the manoeuvre with an air speed that falls by so many per cent after the first step."""
    t = m.channels["airspeed"].t
    fallen = np.clip((t - m.span.start_s) / 3.0, 0.0, 1.0)
    speed = replace(m.channels["airspeed"], y=22.0 * (1.0 - 0.01 * percent * fallen))
    return replace(m, channels={**m.channels, "airspeed": speed})


def contradicted(m: Maneuver, quantity: str) -> Maneuver:
    told = InstrumentFinding("alpha", quantity, "up", "down", 0.1, True, "alpha is reversed", "turn it")
    return replace(m, findings=(told,))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (broken_off, "the telemetry breaks off"),
        (lambda m: slowing(m, 50.0), "air speed changed by 50 %"),
        (lambda m: contradicted(m, "sign"), "alpha is reversed"),
    ],
)
def test_a_manoeuvre_that_no_model_answers_is_not_used(spoil, said):
    *others, last = flown(maneuvers=4)
    found = without_refused([*others, spoil(last)], Aircraft())
    assert found.maneuvers == others
    assert found.notes[0].startswith(f"Manoeuvre 4 is not used: {said}")


@pytest.mark.parametrize("change", [lambda m: slowing(m, 20.0), lambda m: contradicted(m, "delay_s")])
def test_what_the_gap_has_in_its_model_is_no_objection(change):
    maneuvers = [change(m) for m in flown(maneuvers=3)]
    assert without_refused(maneuvers, Aircraft()).notes == ()


@pytest.mark.parametrize("spoil", [lambda m: slowing(m, 50.0), lambda m: contradicted(m, "sign")])
def test_a_log_of_a_contradicted_instrument_or_of_any_speed_cannot_serve(spoil):
    with pytest.raises(UnusableInputError, match="No manoeuvre of the log can be used"):
        without_refused([spoil(m) for m in flown(maneuvers=3)], Aircraft())
