"""What every format writes of an improved simulator, before any format."""

import pytest

from advisor.aircraft.aircraft import Elevator
from advisor.exports.models.improvement import ExportedServo, air_note, servo_of
from advisor.flight.instruments.atmosphere import AirData
from advisor.gap.result import Value
from tests.exports.models.cases import MODEL, air_at, improvement


@pytest.mark.parametrize(
    ("height_m", "density"), [(None, 1.225), (0.0, 1.225), (1100.0, 1.1008), (5000.0, 0.7361)]
)
def test_the_density_is_that_of_the_standard_atmosphere_and_at_sea_level_without_a_height(height_m, density):
    """ICAO's standard atmosphere: 1.225 kg/m³ at sea level, 0.7361 kg/m³ at 5,000 m."""
    note = air_note(air_at(height_m))
    assert f"Air density {density:.4f} kg/m3" in note
    assert ("sea level" in note) is (height_m is None)


def test_an_indicated_speed_has_the_coefficients_of_sea_level_at_any_height():
    """q̄ is ½·1.225·V² for an indicated speed, so that a height without a true speed changes no C_mα."""
    low, high = (
        improvement(air=AirData(density, "height", "indicated")).coefficients()["C_m_alpha"].value
        for density in (1.225, 0.9)
    )
    assert low == pytest.approx(high)
    assert low == pytest.approx(-41.0 * 0.9 / (0.5 * 1.225 * 25.0**2 * 0.8 * 0.3))


def test_the_true_air_speed_that_the_motion_shows_is_that_of_the_coefficients():
    plain, faster = (improvement(air=air_at(1100.0, excess)).coefficients() for excess in (0.0, 0.02))
    assert faster["C_m_alpha"].value == pytest.approx(plain["C_m_alpha"].value / 1.02**2)
    assert faster["C_m_q"].value == pytest.approx(plain["C_m_q"].value / 1.02)
    assert "1.0200 times" in air_note(air_at(1100.0, 0.02))


def test_a_derivative_that_is_not_told_from_zero_is_exported_as_zero_and_said():
    model = improvement().model | {"Z_q": Value(-0.03, 0.02), "M_q": Value(-5.2, 0.1)}
    one = improvement(model=model)
    assert one.coefficients()["C_L_q"].value == 0.0
    assert one.untold == ("Z_q, which is not distinguished from zero and is 0",)


def test_a_prior_value_differs_outside_two_standard_deviations():
    """M_α is -41 with a standard deviation of 0.82, so that its 95 % interval ends 1.607 away."""
    one = improvement()
    for half in (-1.608, 1.608):
        assert one.differs("M_alpha", MODEL["M_alpha"] + half)
        assert not one.differs("M_alpha", MODEL["M_alpha"] + 0.999 * half)


FOUND = {"transport_delay": {"delay_s": 0.03}, "actuator_lag": {"lag_s": 0.08}}


def test_delay_and_lag_of_the_file_and_of_the_flight_add_up():
    servo = servo_of(Elevator(delay_s=0.02, lag_s=0.05), FOUND)
    assert (servo.delay_s, servo.lag_s) == pytest.approx((0.05, 0.13))


def test_a_file_without_a_servo_leaves_what_was_found():
    servo = servo_of(Elevator(), FOUND)
    assert (servo.delay_s, servo.lag_s) == pytest.approx((0.03, 0.08))
    assert servo_of(Elevator(), {}) == ExportedServo()
