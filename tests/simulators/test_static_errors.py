"""Errors of trim, air speed, inertia, weight and density are named before any effect."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.result import TrimDifference, Value
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.uncatalogued.airspeed_scale import AirspeedScale
from advisor.simulators.static_errors import _of_numbers_together, _of_the_speed, _of_the_trims, is_off

GIVEN = np.array([-2.7, 0.02, -0.15, -23.0, -3.4, -29.0])


def examined(scale: float | None = None, air: object = None):
    found = None if scale is None else AirspeedScale(scale, 0.002)
    problem = SimpleNamespace(prior_derivatives=GIVEN)
    return SimpleNamespace(
        findings=SimpleNamespace(airspeed_scale=found, weight=None, air=air, problem=problem)
    )


def found(verdict: str = "parameters", **factors: float):
    values = dict(zip(DERIVATIVES, GIVEN, strict=True))
    model = {name: Value(factors.get(name, 1.0) * x, 0.01 * abs(x)) for name, x in values.items()}
    return SimpleNamespace(verdict=verdict, model=model)


@pytest.mark.parametrize(
    ("simulator", "aircraft", "words"),
    [
        (np.radians(5.4), np.radians(2.0), "trims at 3.4 deg more angle of attack than the aircraft: flaps"),
        (np.radians(2.0), np.radians(3.5), "1.5 deg less angle of attack"),
        (np.radians(2.0), np.radians(2.7), None),
    ],
)
def test_another_trimmed_angle_of_attack_is_told_in_degrees(simulator, aircraft, words):
    told = list(_of_the_trims([TrimDifference("alpha", float(simulator), float(aircraft), 0.001)]))
    assert (told == []) if words is None else (words in told[0])


def test_a_trim_that_scatters_from_manoeuvre_to_manoeuvre_is_not_told():
    assert not is_off(TrimDifference("elevator", 0.05, 0.02, 0.012))
    assert is_off(TrimDifference("elevator", 0.05, 0.02, 0.004))


def test_an_air_speed_that_reads_low_is_told_as_that():
    assert list(_of_the_speed(examined(0.087))) == ["The air speed reads 8 % low by the motion."]
    assert list(_of_the_speed(examined(-0.09))) == ["The air speed reads 10 % high by the motion."]
    assert list(_of_the_speed(examined(0.025))) == []
    assert list(_of_the_speed(examined(None))) == []


MOMENTS = {"M_alpha": 0.8, "M_q": 0.8, "M_delta_e": 0.8}


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        (MOMENTS, "inertia is 1.25 times the simulator's"),
        ({"Z_alpha": 0.8, "Z_delta_e": 0.8}, "mass is 1.25 times the simulator's"),
        ({**MOMENTS, "Z_alpha": 0.8, "Z_delta_e": 0.8}, "the air is denser or thinner"),
        ({"M_alpha": 0.8}, None),
        ({}, None),
    ],
    ids=["inertia", "weight", "density", "one number alone", "nothing"],
)
def test_numbers_that_differ_together_are_told_as_their_one_cause(factors, words):
    told = list(_of_numbers_together(found(**factors), examined()))
    assert (told == []) if words is None else (words in told[0])


def test_numbers_together_are_told_only_where_numbers_are_the_answer():
    assert list(_of_numbers_together(found("effect", **MOMENTS), examined())) == []
