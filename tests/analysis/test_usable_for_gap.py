"""Manoeuvres that no model answers are left out of the diagnosis and named; other objections do not count."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.usable_for_gap import usable_for_gap
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.signals.record import Channel
from advisor.words.problems import UnusableInputError
from tests.gap.generator import Setup, fly

FLOWN = fly(Setup(maneuvers=3, seed=71))


def broken_off(m):
    steps = ((m.span.start_s, 0.05),)
    return replace(m, span=replace(m.span, closed_by="gap", steps=steps))


def slowing(m, percent):
    """Return the manoeuvre with an air speed that falls by so many per cent after the first step."""
    t = m.channels["airspeed"].t
    fallen = np.clip((t - m.span.start_s) / 3.0, 0.0, 1.0)
    speed = replace(m.channels["airspeed"], y=22.0 * (1.0 - 0.01 * percent * fallen))
    return replace(m, channels={**m.channels, "airspeed": speed})


def with_throttle(m):
    t = m.channels["q"].t
    throttle = Channel("throttle", t, np.where(t > m.span.start_s + 1.0, 0.9, 0.3), "VFR_HUD.throttle")
    return replace(m, channels={**m.channels, "throttle": throttle})


def contradicted(m, quantity):
    finding = InstrumentFinding(
        "alpha", quantity, "nose up", "nose down", 0.1, True, "alpha is reversed", "turn it"
    )
    return replace(m, findings=(finding,))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (broken_off, "the telemetry breaks off"),
        (lambda m: slowing(m, 50.0), "air speed changed by 50 %"),
        (lambda m: contradicted(m, "sign"), "alpha is reversed"),
    ],
)
def test_a_manoeuvre_that_no_model_answers_is_left_out_and_named(spoil, said):
    kept, sentences = usable_for_gap([*FLOWN[:2], spoil(FLOWN[2])], Aircraft())
    assert [m.number for m in kept] == [m.number for m in FLOWN[:2]]
    assert len(sentences) == 1
    assert sentences[0].startswith(f"Left out: manoeuvre {FLOWN[2].number}: ")
    assert said in sentences[0]


@pytest.mark.parametrize(
    "change", [with_throttle, lambda m: slowing(m, 20.0), lambda m: contradicted(m, "delay_s")]
)
def test_what_the_diagnosis_has_in_its_model_is_no_objection(change):
    flown = [change(m) for m in FLOWN]
    assert usable_for_gap(flown, Aircraft()) == (flown, [])


def test_where_every_manoeuvre_is_refused_the_first_objection_is_told():
    with pytest.raises(UnusableInputError, match=r"Manoeuvre 1: .*breaks off"):
        usable_for_gap([broken_off(m) for m in FLOWN], Aircraft())
