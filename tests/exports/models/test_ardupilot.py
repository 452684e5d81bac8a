"""ArduPilot's plane: its own equations, written anew from its documentation, fly the derivatives found."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.exports.models.formats.ardupilot_format import FORMAT, parameters_text, plane_text
from advisor.exports.models.improvement import ExportedServo
from advisor.words.problems import ConfigurationError
from tests.exports.models.cases import CALIBRATION, MODEL, REFERENCE, air_at, flown, improvement

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
    plane = read(plane_text(flown(improvement(elevator=calibrated)), "plane.json").text)
    expected = [
        m["Z_0"] + m["Z_alpha"] * alpha + (1.0 + m["Z_q"]) * q + m["Z_delta_e"] * delta,
        m["M_0"] + m["M_alpha"] * alpha + m["M_q"] * q + m["M_delta_e"] * delta,
    ]
    assert rates(plane, alpha, q, pulse_us) == pytest.approx(expected, rel=1e-4, abs=1e-4)


def test_a_surface_that_rests_off_neutral_at_1500_us_moves_the_zero_terms():
    off = Elevator(calibration=((1100.0, -20.0), (1900.0, 28.0)))
    plane = read(plane_text(flown(improvement(elevator=off)), "plane.json").text)
    at_rest = rates(plane, 0.0, 0.0, 1500.0)
    assert at_rest[1] == pytest.approx(MODEL["M_0"] + MODEL["M_delta_e"] * math.radians(4.0), rel=1e-4)


def test_keys_that_the_diagnosis_knows_nothing_of_are_left_to_arduplane():
    assert not {"b", "c_l_p", "c_n_b"} & read(plane_text(flown(improvement()), "plane.json").text).keys()


def test_the_comment_says_which_density_and_which_mass_the_numbers_are_for():
    text = plane_text(flown(improvement()), "plane.json").text
    assert "1.1008 kg/m3, of the standard atmosphere at 1100 m" in text
    assert "2 kg / 10 kg" in text
    assert "sea level" in plane_text(flown(improvement(air=air_at(None))), "plane.json").text


@pytest.mark.parametrize("key", ["mass_kg", "wing_area_m2", "chord_m", "iyy_kg_m2"])
def test_a_missing_reference_is_named(key):
    lacking = flown(improvement(reference=replace(REFERENCE, **{key: None})))
    with pytest.raises(ConfigurationError, match=rf"for want of {key} in the aircraft file"):
        plane_text(lacking, "plane.json")


def test_without_a_calibration_no_coefficient_per_travel_can_be_given():
    with pytest.raises(ConfigurationError, match=r"for want of elevator\.calibration"):
        plane_text(flown(improvement(elevator=Elevator())), "plane.json")


def parameters(servo: ExportedServo) -> dict[str, float]:
    found = all_parameters(flown(improvement(servo=servo)))
    return {name: value for name, value in found.items() if name.startswith("SIM_")}


def all_parameters(model) -> dict[str, float]:
    lines = parameters_text(model).text.splitlines()
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
    assert parameters_text(flown(improved)).left_out == ("actuator backlash", "nonlinear lift")
    assert "nonlinear lift" in plane_text(flown(improved), "plane.json").left_out


def test_drag_and_its_rise_with_lift_are_those_of_the_aircraft_on_the_2_kg_plane():
    """ArduPilot's drag, c_drag_p + C_L²/(π·oswald·b²/s), over 2 kg is that of C_D0 .1 and e .9 over 10 kg."""
    spanned = improvement(reference=replace(REFERENCE, span_m=3.0))
    plane = read(plane_text(flown(spanned), "plane.json").text)
    own = {name: one.value for name, one in spanned.coefficients().items()}
    alpha, aspect = 0.05, 3.0**2 / 0.8
    lift = plane["c_lift_0"] + plane["c_lift_a"] * alpha
    drag = plane["c_drag_p"] + lift**2 / (math.pi * plane["oswald"] * plane["b"] ** 2 / plane["s"])
    neutral = math.radians(0.0)
    own_lift = own["C_L_0"] + own["C_L_alpha"] * alpha + own["C_L_delta_e"] * neutral
    expected = 0.1 + own_lift**2 / (math.pi * 0.9 * aspect)
    assert drag / 2.0 == pytest.approx(expected / 10.0, rel=1e-4)


def test_the_elevator_is_on_output_2_in_the_direction_of_the_calibration():
    """A longer pulse is trailing edge down here: nose down, which ArduPilot calls reversed."""
    found = all_parameters(flown(improvement()))
    assert found["SERVO2_FUNCTION"] == 19.0
    assert found["SERVO2_REVERSED"] == 1.0
    assert (found["SERVO2_MIN"], found["SERVO2_MAX"]) == (1100.0, 1900.0)


def test_the_head_names_the_first_version_that_reads_the_file_and_the_line_to_look_for():
    text = plane_text(flown(improvement()), "plane.json").text
    assert "ArduPlane 4.7 and later print" in text
    assert "Loaded plane aero coefficients from plane.json" in text
    assert "--model plane:plane.json --add-param-file plane.parm" in text


def test_a_name_with_a_brace_leaves_the_first_brace_to_the_coefficients():
    """ArduPilot reads from the first brace of the file."""
    text = plane_text(
        flown(
            improvement(), aircraft=Aircraft("a {b}", Elevator(calibration=CALIBRATION), reference=REFERENCE)
        ),
        "plane.json",
    ).text
    assert json.loads(text[text.index("{") :])["s"] == 0.8


@pytest.mark.parametrize("word", ["-jet", "-heavy", "-ice", "-3d", "-vtail", "-elevon"])
def test_a_file_named_like_one_of_ardupilots_frames_is_refused(word):
    with pytest.raises(ConfigurationError, match=f"takes {word} in my{word}.json for one of its frames"):
        FORMAT.refuse(Path(f"my{word}.json"), Aircraft(), "pitch")
