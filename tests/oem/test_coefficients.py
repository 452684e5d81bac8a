"""Non-dimensional coefficients: there and back again."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.reference import Reference
from advisor.flight.instruments.atmosphere import AirData
from advisor.oem.coefficients import coefficients
from advisor.oem.estimate import Estimate

SPEED, DENSITY = 25.0, 1.1
AIR = AirData(DENSITY, "pressure", "true")
WHOLE = Reference(mass_kg=10.0, wing_area_m2=0.8, chord_m=0.3, iyy_kg_m2=0.9)
LIFT = {"C_L_alpha": 5.1, "C_L_q": 6.0, "C_L_delta_e": 0.45}
MOMENT = {"C_m_alpha": -0.6, "C_m_q": -11.0, "C_m_delta_e": -1.1}


def flown() -> Estimate:
    """Return derivatives of an aircraft with these coefficients, by the definitions of force and moment."""
    pressure = DENSITY * SPEED**2 / 2.0

    def lift(alpha: float, q: float, delta: float) -> float:
        share = (
            LIFT["C_L_alpha"] * alpha + LIFT["C_L_q"] * q * 0.3 / (2.0 * SPEED) + LIFT["C_L_delta_e"] * delta
        )
        return -pressure * 0.8 * share / (10.0 * SPEED)

    def moment(alpha: float, q: float, delta: float) -> float:
        share = MOMENT["C_m_alpha"] * alpha + MOMENT["C_m_q"] * q * 0.3 / (2.0 * SPEED)
        return pressure * 0.8 * 0.3 * (share + MOMENT["C_m_delta_e"] * delta) / 0.9

    unit = np.eye(3)
    z, m = [lift(*row) for row in unit], [moment(*row) for row in unit]
    theta = np.array([0.1, *z, 0.2, *m])
    spread = np.diag((0.01 * theta) ** 2)
    return Estimate(theta, spread, spread, 0.0, (), 1, {"Z_q": "collinear"}, (), 1.0, SPEED)


def test_the_coefficients_that_made_the_derivatives_come_back_with_their_relative_errors() -> None:
    found = coefficients(flown(), WHOLE, AIR)
    for name, true in (LIFT | MOMENT).items():
        if name != "C_L_q":
            assert found[name].value == pytest.approx(true)
            assert found[name].std == pytest.approx(0.01 * abs(true))


def test_a_derivative_that_cannot_be_told_has_no_coefficient() -> None:
    assert "C_L_q" not in coefficients(flown(), WHOLE, AIR)


def test_missing_geometry_leaves_out_what_needs_it() -> None:
    assert set(coefficients(flown(), Reference(mass_kg=10.0, wing_area_m2=0.8), AIR)) == {
        "C_L_alpha",
        "C_L_delta_e",
    }
    assert not coefficients(flown(), Reference(mass_kg=10.0), AIR)
    without_inertia = Reference(mass_kg=10.0, wing_area_m2=0.8, chord_m=0.3)
    assert set(coefficients(flown(), without_inertia, AIR)) == {"C_L_alpha", "C_L_delta_e"}


def test_an_indicated_air_speed_gives_the_coefficients_that_the_true_air_speed_gives() -> None:
    indicated = replace(flown(), airspeed_m_s=SPEED * (DENSITY / 1.225) ** 0.5)
    by_true = coefficients(flown(), WHOLE, AIR)
    by_indicated = coefficients(indicated, WHOLE, AirData(DENSITY, "height", "indicated"))
    for name, one in by_indicated.items():
        assert one.value == pytest.approx(by_true[name].value)
