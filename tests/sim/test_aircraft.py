"""The bundled aircraft's flight dynamics against analytic answers."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from sim.airframe import GRAVITY_M_S2, LIGHT_AIRCRAFT, UAV, as_record
from sim.linear import RESEARCH_JET
from sim.linear_aircraft import LinearAircraft
from sim.motion import Controls
from sim.nonlinear_aircraft import NonlinearAircraft
from sim.trim import TrimError, trim_level

EXAMPLE = Path(__file__).parents[2] / "docs" / "data" / "examples" / "uav.yaml"
AIRCRAFT = [(UAV, 25.0), (LIGHT_AIRCRAFT, 55.0)]


@pytest.mark.parametrize(("airframe", "airspeed"), AIRCRAFT)
def test_a_trimmed_aircraft_flies_on_level_for_ten_seconds(airframe, airspeed):
    aircraft = NonlinearAircraft(airframe, airspeed, 100.0)
    for _ in range(5000):
        motion = aircraft.step(aircraft.trim, 0.002)
    assert motion.airspeed == pytest.approx(airspeed, abs=1e-6)
    assert motion.height == pytest.approx(100.0, abs=1e-5)
    assert motion.theta == pytest.approx(motion.alpha, abs=1e-8)


@pytest.mark.parametrize(("airframe", "airspeed"), AIRCRAFT)
def test_lift_carries_the_weight_at_trim(airframe, airspeed):
    motion = NonlinearAircraft(airframe, airspeed, 100.0).motion()
    total = math.hypot(motion.a_x, motion.a_z)
    assert total == pytest.approx(GRAVITY_M_S2, rel=1e-9)
    assert motion.a_z < 0


def test_an_aircraft_too_slow_to_fly_is_refused_with_a_sentence():
    with pytest.raises(TrimError, match="no level flight at 5 m/s"):
        trim_level(as_record(UAV), 5.0, 100.0)


def test_energy_is_kept_when_neither_thrust_nor_drag_acts():
    from dataclasses import replace

    slick = replace(UAV, cd_0=0.0, cd_induced=0.0)
    aircraft = NonlinearAircraft(slick, 25.0, 100.0)
    before = aircraft.motion()
    pull = Controls(aircraft.trim.elevator - 0.03, 0.0, 0.0)
    for _ in range(2000):
        after = aircraft.step(pull, 0.002)
    energy = [m.airspeed**2 / 2 + GRAVITY_M_S2 * m.height for m in (before, after)]
    assert abs(after.height - before.height) > 3.0
    assert energy[1] == pytest.approx(energy[0], rel=1e-7)


@pytest.mark.parametrize(("airframe", "airspeed"), AIRCRAFT)
def test_specific_forces_agree_with_the_kinematics_of_the_motion(airframe, airspeed):
    aircraft = NonlinearAircraft(airframe, airspeed, 100.0)
    pull = Controls(aircraft.trim.elevator - 0.03, aircraft.trim.throttle, 0.0)
    for _ in range(150):
        m = aircraft.step(pull, 0.002)
    turning = m.airspeed * (m.alpha_dot - m.q)
    a_z = turning * math.cos(m.alpha) + m.airspeed_dot * math.sin(m.alpha) - GRAVITY_M_S2 * math.cos(m.theta)
    a_x = -turning * math.sin(m.alpha) + m.airspeed_dot * math.cos(m.alpha) + GRAVITY_M_S2 * math.sin(m.theta)
    assert m.a_z == pytest.approx(a_z, abs=1e-9)
    assert m.a_x == pytest.approx(a_x, abs=1e-9)


def short_period_response(model, alpha, elevator, step, times):
    """Closed-form response of Eqs. (1)–(2) to an elevator step, by eigenvalues."""
    matrix = np.array([[model.Z_alpha, 1 + model.Z_q], [model.M_alpha, model.M_q]])
    force = np.array([model.Z_delta_e, model.M_delta_e]) * step
    values, vectors = np.linalg.eig(matrix)
    modal = np.linalg.solve(vectors, force)
    response = (vectors @ (modal[:, None] * (np.exp(values[:, None] * times) - 1) / values[:, None])).real
    return alpha + response[0], response[1]


def test_the_linear_aircraft_answers_a_step_as_its_eigenvalues_say():
    aircraft = LinearAircraft(RESEARCH_JET, 100.0, 500.0)
    alpha, elevator = RESEARCH_JET.trim()
    aircraft.step(Controls(elevator - 0.02, 0.5, 0.0), 1e-9)
    flown = [aircraft.step(Controls(elevator - 0.02, 0.5, 0.0), 0.002) for _ in range(1000)]
    times = 0.002 * np.arange(1, 1001)
    expected_alpha, expected_q = short_period_response(RESEARCH_JET, alpha, elevator, -0.02, times)
    np.testing.assert_allclose([m.alpha for m in flown], expected_alpha, atol=1e-9)
    np.testing.assert_allclose([m.q for m in flown], expected_q, atol=1e-9)


@pytest.mark.parametrize(("airframe", "airspeed"), AIRCRAFT)
def test_the_linearisation_predicts_small_motions_of_the_nonlinear_aircraft(airframe, airspeed):
    from dataclasses import replace

    aircraft = NonlinearAircraft(replace(airframe, speed_held=1.0), airspeed, 100.0)
    start = aircraft.motion()
    elevator, step = aircraft.trim.elevator, -1e-4
    pull = Controls(elevator + step, aircraft.trim.throttle, 0.0)
    aircraft.step(pull, 1e-9)
    flown = [aircraft.step(pull, 0.002) for _ in range(300)]
    times = 0.002 * np.arange(1, 301)
    alpha, q = short_period_response(aircraft.truth, start.alpha, elevator, step, times)
    largest_alpha, largest_q = np.abs(alpha - start.alpha).max(), np.abs(q).max()
    assert np.abs([m.alpha for m in flown] - alpha).max() < 0.01 * largest_alpha
    assert np.abs([m.q for m in flown] - q).max() < 0.01 * largest_q


def test_the_light_aircraft_has_the_slower_short_period():
    uav = NonlinearAircraft(UAV, 25.0, 100.0).truth.frequency()
    light = NonlinearAircraft(LIGHT_AIRCRAFT, 55.0, 100.0).truth.frequency()
    assert light < 0.65 * uav


def test_the_example_file_states_the_mass_and_the_wing_that_fly():
    stated = yaml.safe_load(EXAMPLE.read_text(encoding="utf-8"))["reference"]
    assert stated == {
        "mass_kg": UAV.mass,
        "wing_area_m2": UAV.wing_area,
        "chord_m": UAV.chord,
        "span_m": UAV.span,
        "iyy_kg_m2": UAV.iyy,
    }
