"""Gazebo's roll and yaw: its formulas, written anew from its conventions, move as the estimate does."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.exports.models.flown import FlownModel, side_of
from advisor.exports.models.formats.sdf_format import plugins_text
from advisor.exports.models.improvement import STILL_AIR
from advisor.model.axes.lateral import Trim
from tests.campaign.side_builders import estimate

SPEED = 130.0
MASS, IXX, IZZ, IXZ = 9000.0, 20_000.0, 60_000.0, 3_000.0
JET = Aircraft(
    "jet",
    reference=Reference(
        mass_kg=MASS, wing_area_m2=20.0, span_m=9.0, ixx_kg_m2=IXX, izz_kg_m2=IZZ, ixz_kg_m2=IXZ
    ),
)
SIDE = side_of(estimate("aileron", "rudder"), Trim(SPEED), STILL_AIR, JET)


def numbers(text):
    """The plugin's numbers as an XML parser reads them, those of a joint under its name."""
    (plugin,) = ET.fromstring(f"<model>{text}</model>").iter("plugin")
    found = {e.tag: e.text for e in plugin if e.tag != "control_surface"}
    joints = {e.findtext("name"): {x.tag: x.text for x in e} for e in plugin.iter("control_surface")}
    return found, joints


def moved(text, beta, p, r, aileron, rudder):
    """Side force over mass, ṗ and ṙ by the sum of coefficients at a speed without angle of attack."""
    c, joints = numbers(text)
    area, span = float(c["area"]), np.sqrt(float(c["area"]) * float(c["AR"]))
    pressure = 0.5 * float(c["air_density"]) * SPEED**2
    turn = span / (2.0 * SPEED)

    def total(name):
        by_joint = sum(
            np.degrees(angle) * float(joints[joint][f"{name}_ctrl"]) * float(joints[joint]["direction"])
            for joint, angle in (("aileron_joint", aileron), ("rudder_joint", rudder))
        )
        by_motion = float(c[f"{name}b"]) * beta + turn * (float(c[f"{name}p"]) * p + float(c[f"{name}r"]) * r)
        return pressure * area * (by_motion + by_joint)

    inertia = np.array([[IXX, -IXZ], [-IXZ, IZZ]])
    rates = np.linalg.solve(inertia, span * np.array([total("Cell"), total("Cen")]))
    return [total("CY") / MASS, *rates]


@pytest.mark.parametrize(
    "motion",
    [
        {"beta": 0.05},
        {"p": 0.3},
        {"r": 0.2},
        {"delta_a": 0.1},
        {"delta_r": 0.1},
    ],
)
def test_the_plugin_has_side_force_and_rates_of_the_estimate(motion):
    text = plugins_text(FlownModel(JET, None, SIDE)).text
    names = ("beta", "p", "r", "delta_a", "delta_r")
    found = moved(text, *(motion.get(name, 0.0) for name in names))
    theta = dict(zip(SIDE_PARAMETERS, SIDE.numbers, strict=True))
    expected = [sum(theta[f"{y}_{name}"] * value for name, value in motion.items()) for y in "YLN"]
    assert found == pytest.approx([SPEED * expected[0], *expected[1:]], rel=1e-5, abs=1e-9)


def test_the_plugin_lifts_nothing_and_its_drag_is_a_number():
    """The plugin divides by the span's ratio and by the efficiency."""
    c, _ = numbers(plugins_text(FlownModel(JET, None, SIDE)).text)
    assert float(c["CLa"]) == float(c["CL0"]) == 0.0
    assert float(c["AR"]) > 0.0
    assert float(c["eff"]) > 0.0


def test_an_axis_whose_inertia_is_missing_is_named():
    lacking = replace(JET, reference=replace(JET.reference, izz_kg_m2=None))
    with pytest.raises(Exception, match="roll and yaw, for want of reference izz_kg_m2"):
        plugins_text(FlownModel(lacking, None, SIDE))
