"""Errors of trim, air speed, inertia, weight and density are named before any effect."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.signals.record import Channel
from advisor.gap.records.prepare import prepare
from advisor.gap.result import TrimDifference, Value
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.uncatalogued.weight_check import AirspeedScale
from advisor.simulators.compare import compare
from advisor.simulators.protocol import Condition, Inputs
from advisor.simulators.static_errors import (
    _of_numbers_together,
    _of_the_speed,
    _of_the_trims,
    is_off,
    trim_differences,
)
from tests.simulators.nonlinear import TRIM_RAD, Nonlinear, flown

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


CALIBRATED = Aircraft(elevator=Elevator(calibration=((1000.0, -25.0), (2000.0, 25.0))))


def trimmed(aircraft: Aircraft, elevator: float, throttle: float):
    """Return the differences to a simulator that trims at these controls, and at the aircraft's alpha."""
    maneuvers = flown(maneuvers=2)
    for i, m in enumerate(maneuvers):
        t = m.channels["q"].t
        setting = Channel("throttle", t, np.full(len(t), 0.5), "test", "measured")
        maneuvers[i] = replace(m, channels={**m.channels, "throttle": setting})
    t = 0.005 * np.arange(100)
    replay = Nonlinear().replay(Condition(25.0), Inputs(t, 0.0 * t))
    replay = replace(replay, trim={"elevator": elevator, "throttle": throttle})
    flights = prepare(maneuvers, aircraft)
    return {d.quantity: d for d in trim_differences(flights, maneuvers, [replay] * 2, aircraft)}


def test_trims_are_means_before_the_first_step():
    found = trimmed(CALIBRATED, 0.03, 0.7)
    assert found["alpha"].aircraft == pytest.approx(TRIM_RAD, abs=5e-4)
    assert not is_off(found["alpha"])
    assert is_off(found["elevator"])
    assert found["throttle"].simulator - found["throttle"].aircraft == pytest.approx(0.2)


def test_an_elevator_without_a_calibration_tells_no_trim():
    assert set(trimmed(Aircraft(), 0.03, 0.7)) == {"alpha", "throttle"}


@pytest.mark.study
def test_flaps_are_told_as_a_trim_before_anything_else():
    class Clean(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            flown = super().replay(condition, inputs, increments)
            more = np.radians(3.4)
            return replace(flown, alpha=flown.alpha + more, theta=flown.theta + more)

    found = compare(flown(maneuvers=4), Clean(), Aircraft()).diagnosis
    assert found.sentence.startswith("The simulator trims at 3.4 deg more angle of attack than the aircraft")
    assert found.verdict in ("none", "parameters")
