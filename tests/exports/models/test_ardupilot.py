"""ArduPilot's plane: its own equations, written anew from its documentation, fly the derivatives found."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.controls import Elevator
from advisor.exports.models.ardupilot import model_text, servo_text
from advisor.exports.models.servo import ExportedServo
from advisor.words.problems import ConfigurationError
from tests.exports.models.cases import MODEL, REFERENCE, improvement

DENSITY, SPEED, GRAVITY = 1.1008, 25.0, 9.80665  # standard atmosphere at 1,100 m


def read(text: str) -> dict[str, float]:
    """A model file as ArduPilot reads it: lines of comment are left out, the rest is JSON."""
    return json.loads("\n".join(line for line in text.splitlines() if not line.startswith("#")))


def rates(plane: dict[str, float], alpha: float, q: float, pulse_us: float) -> np.ndarray:
    """α̇ and q̇ of ArduPilot's plane in level flight at a small angle: mass 2 kg, inertia 1 kg·m²."""
    elevator = (pulse_us - 1500.0) / 500.0
    pressure, turn = 0.5 * DENSITY * SPEED**2 * plane["s"], plane["c"] * q / (2.0 * SPEED)
    lift = plane["c_lift_0"] + plane["c_lift_a"] * alpha + plane["c_lift_q"] * turn
    lift += plane["c_lift_deltae"] * elevator
    pitch = plane["c_m_0"] + plane["c_m_a"] * alpha + plane["c_m_q"] * turn + plane["c_m_deltae"] * elevator
    return np.array([q + GRAVITY / SPEED - pressure * lift / (2.0 * SPEED), pressure * plane["c"] * pitch])


@pytest.mark.parametrize(
    ("alpha", "q", "pulse_us", "delta_deg"),
    [(0.0, 0.0, 1500.0, 0.0), (0.05, 0.0, 1500.0, 0.0), (0.0, 0.3, 1500.0, 0.0), (0.02, 0.1, 1900.0, 24.0)],
)
def test_the_plane_has_the_rates_of_the_model_found(alpha, q, pulse_us, delta_deg):
    m, delta = MODEL, math.radians(delta_deg)
    calibrated = Elevator(calibration=((1100.0, -24.0), (1500.0, 0.0), (1900.0, 24.0)))
    plane = read(model_text(improvement(elevator=calibrated)).text)
    expected = [
        m["Z_0"] + m["Z_alpha"] * alpha + (1.0 + m["Z_q"]) * q + m["Z_delta_e"] * delta,
        m["M_0"] + m["M_alpha"] * alpha + m["M_q"] * q + m["M_delta_e"] * delta,
    ]
    assert rates(plane, alpha, q, pulse_us) == pytest.approx(expected, rel=1e-4, abs=1e-4)


def test_a_surface_that_rests_off_neutral_at_1500_us_moves_the_zero_terms():
    off = Elevator(calibration=((1100.0, -20.0), (1900.0, 28.0)))
    plane = read(model_text(improvement(elevator=off)).text)
    at_rest = rates(plane, 0.0, 0.0, 1500.0)
    assert at_rest[1] == pytest.approx(MODEL["M_0"] + MODEL["M_delta_e"] * math.radians(4.0), rel=1e-4)


def test_keys_that_the_diagnosis_knows_nothing_of_are_left_to_arduplane():
    assert not {"b", "c_drag_p", "c_l_p", "c_n_b"} & read(model_text(improvement()).text).keys()


def test_the_comment_says_which_density_and_which_mass_the_numbers_are_for():
    text = model_text(improvement()).text
    assert "1.1008 kg/m3, of the standard atmosphere at 1100 m" in text
    assert "2 kg / 10 kg" in text
    assert "sea level" in model_text(improvement(height_m=None)).text


@pytest.mark.parametrize("key", ["mass_kg", "wing_area_m2", "chord_m", "iyy_kg_m2"])
def test_a_missing_reference_is_named(key):
    with pytest.raises(ConfigurationError, match=rf"need {key}; give it under reference:"):
        model_text(improvement(reference=replace(REFERENCE, **{key: None})))


def test_without_a_calibration_no_coefficient_per_travel_can_be_given():
    with pytest.raises(ConfigurationError, match=r"give elevator\.calibration"):
        model_text(improvement(elevator=Elevator()))


def parameters(servo: ExportedServo) -> dict[str, float]:
    lines = servo_text(improvement(servo=servo)).text.splitlines()
    return {n: float(v) for n, v in (line.split() for line in lines if not line.startswith("#"))}


def test_a_lag_alone_is_the_time_constant_that_arduplane_takes_the_servo_speed_for():
    found = parameters(ExportedServo(lag_s=0.08))
    assert found == {"SIM_SERVO_SPEED": 0.08, "SIM_SERVO_DELAY": 0.0, "SIM_SERVO_FILTER": 0.0}


def test_a_lag_beside_a_delay_becomes_a_filter_that_trails_a_ramp_by_the_lag():
    found = parameters(ExportedServo(lag_s=0.08, delay_s=0.03))
    assert found["SIM_SERVO_DELAY"] == 0.03
    assert found["SIM_SERVO_SPEED"] == 0.0
    omega = 2.0 * math.pi * found["SIM_SERVO_FILTER"]
    # A Butterworth filter of two poles is s² + √2·ω·s + ω²: its delay at low frequency is √2/ω.
    assert math.sqrt(2.0) / omega == pytest.approx(0.08, rel=1e-4)


def test_a_rate_limit_becomes_the_time_for_60_degrees_of_a_servo_of_45_degrees():
    found = parameters(ExportedServo(rate_rad_s=1.0))
    per_second = 60.0 / (45.0 * found["SIM_SERVO_SPEED"])
    assert per_second * math.radians(30.0) == pytest.approx(1.0, rel=1e-4)
    assert found["SIM_SERVO_DELAY"] > 0.0


def test_what_arduplane_cannot_fly_is_listed():
    improved = improvement(servo=ExportedServo(play_rad=0.01), effects={"nonlinear_lift": {"Z_alpha2": 3.0}})
    assert servo_text(improved).left_out == ("actuator backlash", "nonlinear lift")
    assert "nonlinear lift" in model_text(improved).left_out
