"""Gazebo's lift-drag block: read by an XML parser, the two surfaces have the derivatives found."""

import xml.etree.ElementTree as ET

import pytest

from advisor.exports.models.formats.sdf_format import block_text
from advisor.gap.result import Value
from advisor.words.problems import ConfigurationError
from tests.exports.models.cases import MODEL, REFERENCE, improvement

SPEED, GRAVITY = 25.0, 9.80665


def surfaces(text: str) -> list[dict[str, str]]:
    """The plugins' numbers, as an XML parser reads them inside a model."""
    model = ET.fromstring(f"<model>{text}</model>")
    return [{e.tag: e.text or "" for e in plugin} for plugin in model.findall("plugin")]


def rates(text: str, alpha: float, q: float, joint: float) -> tuple[float, float]:
    """α̇ and q̇ by the forces of all surfaces at their centres of pressure, in the air that they meet."""
    lift = moment = 0.0
    for one in surfaces(text):
        ahead = float(one["cp"].split()[0])
        local = alpha - q * ahead / SPEED
        c_lift = float(one["cla"]) * (float(one["a0"]) + local)
        c_lift += float(one.get("control_joint_rad_to_cl", 0.0)) * joint
        force = 0.5 * float(one["air_density"]) * SPEED**2 * float(one["area"]) * c_lift
        lift, moment = lift + force, moment + ahead * force
    mass, inertia = REFERENCE.mass_kg, REFERENCE.iyy_kg_m2
    return q + GRAVITY / SPEED - lift / (mass * SPEED), moment / inertia


def test_the_surfaces_have_the_derivatives_found():
    text = block_text(improvement()).text
    at_rest = rates(text, 0.0, 0.0, 0.0)
    assert at_rest == pytest.approx((MODEL["Z_0"], MODEL["M_0"]), rel=1e-5)
    by_alpha = [moved - rest for moved, rest in zip(rates(text, 1e-2, 0.0, 0.0), at_rest, strict=True)]
    assert by_alpha == pytest.approx([1e-2 * MODEL["Z_alpha"], 1e-2 * MODEL["M_alpha"]], rel=1e-5)
    assert rates(text, 0.0, 1e-2, 0.0)[1] - at_rest[1] == pytest.approx(1e-2 * MODEL["M_q"], rel=1e-5)
    assert rates(text, 0.0, 0.0, 1e-2)[1] - at_rest[1] == pytest.approx(1e-2 * MODEL["M_delta_e"], rel=1e-5)


def test_the_tail_is_behind_the_centre_of_gravity_and_has_the_joint():
    wing, tail = surfaces(block_text(improvement()).text)
    assert float(wing["cp"].split()[0]) == 0.0
    assert float(tail["cp"].split()[0]) < 0.0
    assert "control_joint_name" in tail
    assert "control_joint_name" not in wing


def test_the_block_says_what_it_keeps_and_what_it_implies():
    text = block_text(improvement()).text
    assert "Kept: C_L_alpha, C_m_alpha, C_m_q, C_m_delta_e. Implied: C_L_delta_e" in text
    assert "no part of LiftDrag: lag 0.08 s" in text


def test_a_name_with_signs_of_xml_stays_a_comment():
    assert len(surfaces(block_text(improvement(name="a --> <plugin/> & b")).text)) == 2


def test_an_unstable_aircraft_has_no_such_tail():
    model = improvement().model | {"M_alpha": Value(4.0, 0.1)}
    with pytest.raises(ConfigurationError, match="need M_alpha and M_q below zero"):
        block_text(improvement(model=model))


def test_the_lag_is_listed_as_left_out():
    assert block_text(improvement()).left_out == ("lag 0.08 s",)


def test_a_tail_that_lifts_more_than_the_aircraft_is_no_tail():
    model = improvement().model | {"M_q": Value(-0.05, 0.01)}
    with pytest.raises(ConfigurationError, match="would lift more than the whole aircraft"):
        block_text(improvement(model=model))
