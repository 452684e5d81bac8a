"""Roll and yaw of ArduPilot's plane: its equations, written anew from its conventions, fly the model."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.exports.models.flown import FlownModel, side_of
from advisor.exports.models.formats.ardupilot_format import plane_text
from advisor.exports.models.improvement import STILL_AIR
from advisor.exports.models.write import carry_out, order_of
from advisor.gap.result import Value
from advisor.model.axes.lateral import Trim
from advisor.words.problems import ConfigurationError
from tests.campaign.side_builders import estimate
from tests.exports.models.cases import REFERENCE, improvement
from tests.oem.axis.builders import JET

SPEED, DENSITY = 130.0, 1.225
RIGHT_ROLLS = SideControl(calibration=((1000.0, 20.0), (1500.0, 0.0), (2000.0, -20.0)))
RIGHT_YAWS = SideControl(calibration=((1100.0, 12.0), (1900.0, -12.0)))
AIRCRAFT = Aircraft(
    reference=Reference(wing_area_m2=20.0, span_m=9.0), aileron=RIGHT_ROLLS, rudder=RIGHT_YAWS
)
SIDE = side_of(estimate("aileron", "rudder"), Trim(SPEED, 0.07, 0.105), STILL_AIR, AIRCRAFT)


def text_of(side=SIDE, aircraft=AIRCRAFT):
    return plane_text(FlownModel(aircraft, None, side), "plane.json").text


def read(text):
    return json.loads("\n".join(line for line in text.splitlines() if not line.startswith("#")))


def plane_rates(plane, beta, p, r, aileron_us, rudder_us):
    """Specific side force, ṗ and ṙ of ArduPilot's plane: mass 2 kg, inertia 1 kg·m²."""
    ail, rud = (aileron_us - 1500.0) / 500.0, (rudder_us - 1500.0) / 500.0
    force = 0.5 * DENSITY * SPEED**2 * plane["s"]
    turn = plane["b"] / (2.0 * SPEED)

    def total(letter):
        return (
            plane[f"c_{letter}_b"] * beta
            + plane[f"c_{letter}_p"] * turn * p + plane[f"c_{letter}_r"] * turn * r
            + plane[f"c_{letter}_deltaa"] * ail + plane[f"c_{letter}_deltar"] * rud
        )  # fmt: skip

    moment = force * plane["b"]
    return np.array([force * total("y") / 2.0, moment * total("l"), moment * total("n")])


@pytest.mark.parametrize(
    ("beta", "p", "r", "aileron_us", "rudder_us"),
    [
        (0.05, 0.0, 0.0, 1500.0, 1500.0),
        (0.0, 0.3, 0.0, 1500.0, 1500.0),
        (0.0, 0.0, 0.2, 1500.0, 1500.0),
        (0.0, 0.0, 0.0, 1700.0, 1500.0),
        (0.0, 0.0, 0.0, 1500.0, 1700.0),
    ],
)
def test_the_plane_has_side_force_and_rates_of_the_estimate(beta, p, r, aileron_us, rudder_us):
    plane = read(text_of())
    aileron = np.radians(-20.0 * (aileron_us - 1500.0) / 500.0)
    rudder = np.radians(-15.0 * (rudder_us - 1500.0) / 500.0)
    theta = dict(zip(SIDE_PARAMETERS, SIDE.numbers, strict=True))
    moved = {"beta": beta, "p": p, "r": r, "delta_a": aileron, "delta_r": rudder}
    expected = [sum(theta[f"{y}_{name}"] * value for name, value in moved.items()) for y in "YLN"]
    expected[0] *= SPEED
    assert plane_rates(plane, beta, p, r, aileron_us, rudder_us) == pytest.approx(
        expected, rel=1e-4, abs=1e-6
    )


def test_a_longer_pulse_rolls_and_yaws_to_the_right_as_arduplane_expects():
    plane = read(text_of())
    assert JET["L_delta_a"] < 0.0 < plane["c_l_deltaa"]
    assert JET["N_delta_r"] < 0.0 < plane["c_n_deltar"]
    assert plane["c_n_b"] > 0.0 > plane["c_l_b"]


def test_a_derivative_that_is_not_told_has_no_key_and_its_reason_is_said():
    found = estimate("aileron", untold={"N_p": "fly a rudder doublet"})
    untold = side_of(found, SIDE.trim, STILL_AIR, AIRCRAFT)
    made = plane_text(FlownModel(AIRCRAFT, None, untold), "plane.json")
    assert "c_n_p" not in read(made.text)
    assert "N_p: fly a rudder doublet" in made.left_out


def test_a_derivative_that_is_not_told_from_zero_is_zero_and_said():
    unsure = replace(SIDE, values={**SIDE.values, "L_r": Value(0.2, 0.15)})
    assert read(text_of(unsure))["c_l_r"] == 0.0
    assert "L_r, which is not distinguished from zero and is 0" in unsure.left_out


def test_the_read_air_speed_that_is_too_low_makes_no_coefficient_too_large():
    """The true air speed is 2 % above the read one: forces go with its square, at the density of the air."""
    faster = replace(SIDE, air=replace(STILL_AIR, excess=0.02))
    plain, true = read(text_of()), read(text_of(faster))
    assert true["c_l_b"] == pytest.approx(plain["c_l_b"] / 1.02**2, rel=1e-4)
    assert true["c_l_p"] == pytest.approx(plain["c_l_p"] / 1.02, rel=1e-4)


@pytest.mark.parametrize(
    ("lacking", "said"),
    [
        ({"reference": Reference(wing_area_m2=20.0)}, "for want of span_m"),
        ({"rudder": SideControl()}, r"for want of rudder\.calibration"),
    ],
)
def test_without_span_or_calibration_the_message_names_the_key(lacking, said):
    with pytest.raises(ConfigurationError, match=said):
        text_of(aircraft=replace(AIRCRAFT, **lacking))


def test_both_axes_are_in_one_file():
    pitch = improvement(reference=replace(REFERENCE, span_m=9.0))
    both = replace(AIRCRAFT, elevator=pitch.elevator, reference=pitch.reference)
    plane = read(plane_text(FlownModel(both, pitch, SIDE), "plane.json").text)
    assert {"c_m_a", "c_lift_a", "c_drag_p", "c_l_p", "c_n_r", "c_y_b"} <= plane.keys()


def test_the_flight_of_an_analysis_is_written_to_the_json_file(tmp_path: Path):
    order = order_of(f"ardupilot:{tmp_path / 'plane.json'}")
    (outcome,) = carry_out([order], FlownModel(AIRCRAFT, None, SIDE))
    assert outcome.problem == ""
    assert read(order.file.read_text())["b"] == 9.0
    parameters = (tmp_path / "plane.parm").read_text()
    assert "SERVO1_FUNCTION 4\nSERVO1_REVERSED 0\n" in parameters
    assert "SERVO4_FUNCTION 21\nSERVO4_REVERSED 0\n" in parameters
