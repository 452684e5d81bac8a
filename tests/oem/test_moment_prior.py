"""Usual sizes of stability and damping, where no angle of attack is measured."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Alpha
from advisor.aircraft.reference import Reference
from advisor.model.outputs import SHARED
from advisor.oem.prepare import prepare
from advisor.oem.prior import precision
from tests.oem.test_instruments import SPEED, equipped

GEOMETRY = Reference(mass_kg=3.1, wing_area_m2=0.6, chord_m=0.2, iyy_kg_m2=0.25)
BLIND = Aircraft(airspeed_m_s=SPEED, reference=GEOMETRY, alpha=Alpha(source="none"))
SHARED_UAV = np.array([-8.0, 0.0, 0.8, -48.0, -4.0, -100.0, 0.0])


def std_of(aircraft, name):
    """Return the prior's standard deviation of a derivative."""
    problem = prepare([equipped(noise=0.02)], aircraft).problem
    weight = precision(problem, SHARED_UAV)[SHARED.index(name)]
    return np.inf if weight == 0.0 else weight**-0.5


def test_without_a_vane_stability_and_damping_have_the_sizes_of_usual_coefficients():
    pressure = 0.5 * 1.225 * SPEED**2
    per_stability = pressure * 0.6 * 0.2 / 0.25
    assert std_of(BLIND, "M_alpha") == pytest.approx(1.5 * per_stability, rel=1e-6)
    assert std_of(BLIND, "M_q") == pytest.approx(20.0 * per_stability * 0.2 / (2.0 * SPEED), rel=1e-6)


@pytest.mark.parametrize(
    "known",
    [replace(BLIND, alpha=Alpha()), replace(BLIND, reference=Reference(mass_kg=3.1))],
    ids=["a vane", "no geometry"],
)
def test_with_a_vane_or_without_the_geometry_stability_is_left_to_the_data(known):
    assert std_of(known, "M_alpha") == np.inf


def test_control_power_has_no_usual_size():
    assert std_of(BLIND, "M_delta_e") == np.inf
