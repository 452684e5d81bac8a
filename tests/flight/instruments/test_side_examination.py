"""Instruments of roll and yaw against the motion alone, on simulated doublets."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.measured import pooled
from advisor.flight.signals.record import Channel
from advisor.oem.rows import Signal
from tests.oem.axes.lateral.builders import JET, flown, rudder_doublet, steps

SMALL = JET | {"Y_beta": -0.5}
SOURCE = {"a_y": "RAW_IMU.yacc", "beta": "AOA_SSA.SSA"}


@cache
def flight(vane=True):
    """Return the channels of an aileron doublet to 30 deg of bank, and of a rudder doublet."""
    measured = ("p", "r", "bank", "a_y", "beta") if vane else ("p", "r", "bank", "a_y")
    t, rng = np.arange(0.0, 15.0, 0.025), np.random.default_rng(2)
    hands, feet = steps(t, (1.0, 3.0, 5.0), (0.1, -0.1, 0.0)), rudder_doublet(t)
    inputs = {"aileron": hands}, {"rudder": feet}
    records = [flown(SMALL, **one, airspeed=25.0, measured=measured, rng=rng) for one in inputs]
    return tuple(map(channels_of, records))


def channels_of(record):
    known = {name: getattr(record, name) for name in ("airspeed", "alpha", "theta", "q")}
    t = record.outputs["p"].t
    told = dict(record.outputs) | {n: Signal(t, s.at(t)) for n, s in known.items()}
    return {
        name: Channel(name, s.t, s.y, SOURCE.get(name, f"ATTITUDE.{name}"), "measured")
        for name, s in told.items()
    }


def findings(change, vane=True):
    """Return the codes of the contradictions in both doublets together, after a change of the channels."""
    evidence = {}
    for channels in flight(vane):
        examined = examine_side(change(channels), evidence)
        evidence = pooled((evidence, examined.evidence))
    return {f.code: f for f in examined.findings}


def scaled(name, factor):
    return lambda channels: {**channels, name: replace(channels[name], y=factor * channels[name].y)}


def late(name, by_s):
    return lambda channels: {**channels, name: replace(channels[name], t=channels[name].t + by_s)}


@pytest.mark.parametrize("vane", [True, False])
def test_sound_instruments_contradict_nothing(vane):
    assert findings(dict, vane) == {}


@pytest.mark.parametrize("name", ["a_y", "beta", "r", "p"])
def test_a_reversed_channel_is_named_by_the_motion(name):
    found = findings(scaled(name, -1.0))
    assert list(found) == [f"{name}_sign"]
    assert found[f"{name}_sign"].refuses


@pytest.mark.parametrize("by_s", [1.7, -1.5])
def test_a_sideslip_of_another_clock_is_not_accused_of_its_sign(by_s):
    (found,) = examine_side(late("beta", by_s)(flight()[0])).findings
    assert found.code == "beta_delay_s"
    assert found.value == pytest.approx(by_s, abs=0.3)
    assert ("late" if by_s > 0.0 else "early") in found.text


def test_the_sentence_of_a_wrong_sign_holds_the_number_that_excludes_the_right_one():
    text = findings(scaled("beta", -1.0))["beta_sign"].text
    value, half = (float(x) for x in text.partition("with ")[2].split(" ")[:3:2])
    assert value + half < 0.0


def test_a_reversed_side_force_is_named_without_a_vane():
    assert list(findings(scaled("a_y", -1.0), vane=False)) == ["a_y_sign"]


def test_bank_and_roll_rate_that_are_both_reversed_contradict_the_weight():
    both = scaled("p", -1.0)
    assert list(findings(lambda c: scaled("bank", -1.0)(both(c)))) == ["bank_sign"]


@pytest.mark.parametrize("vane", [True, False])
def test_a_side_force_in_g_where_mg_are_stated_is_named(vane):
    found = findings(scaled("a_y", 1e-3), vane)
    assert list(found) == ["a_y_unit"]
    assert found["a_y_unit"].refuses


def test_a_roll_rate_in_degrees_is_named():
    assert findings(scaled("p", 180.0 / np.pi))["p_unit"].value == "deg/s"


def test_a_late_bank_is_set_earlier_and_used():
    found = findings(late("bank", 0.1))["bank_delay_s"]
    assert found.used
    assert found.value == pytest.approx(0.1, abs=0.01)


def test_a_late_roll_rate_refuses():
    assert findings(late("p", 0.1))["p_delay_s"].refuses


def test_a_vertical_force_of_an_unknown_unit_is_blamed_before_the_side_force():
    def of_another_unit(channels):
        bank = channels["bank"]
        third = np.full(len(bank.t), -9.81 / 3.0)
        a_z = Channel("a_z", bank.t, third, "RAW_IMU.zacc", "measured")
        return scaled("a_y", -1.0)({**channels, "a_z": a_z})

    assert list(findings(of_another_unit)) == ["a_z_scale"]
