"""Roll and yaw of ArduPilot's plane: its equations, written anew from its conventions, fly the model."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.exports.models.ardupilot_side import side_model_text
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.write import order_of, write_flown
from advisor.model.lateral import Trim
from advisor.words.problems import ConfigurationError
from tests.campaign.side_builders import estimate
from tests.oem.lateral_builders import JET

SPEED, DENSITY = 130.0, 1.225
SIDE = SideModel(estimate("aileron", "rudder"), Trim(SPEED, 0.07, 0.105), 0.0)
RIGHT_ROLLS = SideControl(calibration=((1000.0, 20.0), (1500.0, 0.0), (2000.0, -20.0)))
RIGHT_YAWS = SideControl(calibration=((1100.0, 12.0), (1900.0, -12.0)))
AIRCRAFT = Aircraft(
    reference=Reference(wing_area_m2=20.0, span_m=9.0), aileron=RIGHT_ROLLS, rudder=RIGHT_YAWS
)


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
    plane = read(side_model_text("jet", SIDE, AIRCRAFT).text)
    aileron = np.radians(-20.0 * (aileron_us - 1500.0) / 500.0)
    rudder = np.radians(-15.0 * (rudder_us - 1500.0) / 500.0)
    theta = dict(zip(SIDE_PARAMETERS, SIDE.found.estimate.theta, strict=True))
    moved = {"beta": beta, "p": p, "r": r, "delta_a": aileron, "delta_r": rudder}
    expected = [sum(theta[f"{y}_{name}"] * value for name, value in moved.items()) for y in "YLN"]
    expected[0] *= SPEED
    assert plane_rates(plane, beta, p, r, aileron_us, rudder_us) == pytest.approx(
        expected, rel=1e-4, abs=1e-6
    )


def test_a_longer_pulse_rolls_and_yaws_to_the_right_as_arduplane_expects():
    plane = read(side_model_text("jet", SIDE, AIRCRAFT).text)
    assert JET["L_delta_a"] < 0.0 < plane["c_l_deltaa"]
    assert JET["N_delta_r"] < 0.0 < plane["c_n_deltar"]
    assert plane["c_n_b"] > 0.0 > plane["c_l_b"]


def test_a_derivative_that_is_not_told_has_no_key_and_its_reason_is_said():
    untold = replace(SIDE, found=estimate("aileron", untold={"N_p": "fly a rudder doublet"}))
    made = side_model_text("jet", untold, AIRCRAFT)
    assert "c_n_p" not in read(made.text)
    assert made.left_out == ("N_p: fly a rudder doublet",)


def test_without_span_or_calibration_the_message_names_the_key():
    with pytest.raises(ConfigurationError, match="need span_m"):
        side_model_text("jet", SIDE, replace(AIRCRAFT, reference=Reference(wing_area_m2=20.0)))
    with pytest.raises(ConfigurationError, match=r"give rudder\.calibration"):
        side_model_text("jet", SIDE, replace(AIRCRAFT, rudder=SideControl()))


def test_the_flight_of_an_analysis_is_written_to_the_json_file(tmp_path: Path):
    order = order_of(f"ardupilot:{tmp_path / 'plane.json'}")
    (outcome,) = write_flown([order], FlownModel("jet", None, SIDE), AIRCRAFT)
    assert outcome.problem == ""
    assert read(order.file.read_text())["b"] == 9.0
