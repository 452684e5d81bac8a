"""Equation error: a linear regression next to output error."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.equation_error import equation_error, lateral_equation_error
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.surface import Servo
from tests.oem.axis.builders import JET as SIDE_JET
from tests.oem.axis.builders import both_inputs
from tests.oem.builders import JET, by_name, flown


def regressed(noise: float, **more):
    found = prepare([flown(JET, noise=noise, seed=k, number=k, **more) for k in (1, 2)], Aircraft())
    assert isinstance(found, Prepared)
    return equation_error(found.problem)


@pytest.mark.parametrize("name", ["Z_alpha", "M_alpha", "M_q", "M_delta_e"])
def test_without_noise_equation_error_gives_the_aircraft(name):
    assert regressed(0.0)[name].value == pytest.approx(by_name(JET)[name], rel=0.01)


def test_its_intervals_widen_with_the_noise():
    quiet, loud = regressed(0.005), regressed(0.05)
    assert loud["M_alpha"].std > 3.0 * quiet["M_alpha"].std


def test_it_takes_the_servo_of_the_problem_it_is_given():
    problem = both_inputs(SIDE_JET)
    late = lateral_equation_error(type(problem)(problem.records, servos={"aileron": Servo(0.1, 0.0)}))
    assert not np.isclose(late["L_delta_a"].value, lateral_equation_error(problem)["L_delta_a"].value)


@pytest.mark.parametrize("name", ["L_p", "L_delta_a", "N_beta", "N_delta_r"])
def test_without_noise_it_gives_roll_and_yaw_too(name):
    assert lateral_equation_error(both_inputs(SIDE_JET))[name].value == pytest.approx(
        SIDE_JET[name], rel=0.05
    )


def test_without_an_angle_of_attack_there_is_none():
    found = prepare([flown(JET)], Aircraft())
    assert isinstance(found, Prepared)
    record = found.problem.records[0]
    blind = type(record)(record.elevator, {"q": record.outputs["q"], "a_z": record.outputs["q"]})
    assert equation_error(type(found.problem)((blind,))) == {}
