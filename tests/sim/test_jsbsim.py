"""JSBSim's six degrees of freedom behind the same controls, instruments and effects."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.airframe import GRAVITY_M_S2
from sim.effects.fitting import flight_of
from sim.jsbsim_aircraft import JsbsimAircraft
from sim.loading import ScenarioError
from sim.scenario import Maneuver, Noise, Scenario

CESSNA = Scenario(
    engine="jsbsim",
    aircraft="c172p",
    height_m=1000.0,
    maneuvers=(Maneuver("3211"),),
    noise=Noise(),
    lead_in_s=3.0,
)


@pytest.fixture(scope="module")
def plain():
    return list(flight_of(CESSNA).samples())


def channel(samples, name):
    return np.array([getattr(sample.reading, name) for sample in samples])


def test_the_aircraft_is_trimmed_before_it_flies(plain):
    before = [sample.motion for sample in plain if sample.time_s < 3.0]
    assert max(abs(m.q) for m in before) < math.radians(0.3)
    assert max(abs(m.height - 1000.0) for m in before) < 1.0
    assert max(abs(m.airspeed - 53.0) for m in before) < 0.1


def test_forces_agree_with_the_kinematics_of_the_motion(plain):
    for motion in (sample.motion for sample in plain if sample.flying and sample.time_s > 1.0):
        turning = motion.airspeed * (motion.alpha_dot - motion.q)
        expected = (
            turning * math.cos(motion.alpha)
            + motion.airspeed_dot * math.sin(motion.alpha)
            - GRAVITY_M_S2 * math.cos(motion.theta) * math.cos(motion.phi)
        )
        assert motion.a_z == pytest.approx(expected, abs=0.08)


def test_its_short_period_explains_the_flight(plain):
    truth = flight_of(CESSNA).engine.truth
    flown = [sample.motion for sample in plain if sample.flying]
    q_dot = np.array([m.q_dot for m in flown])
    by_model = [
        truth.M_0 + truth.M_alpha * m.alpha + truth.M_q * m.q + truth.M_delta_e * m.elevator for m in flown
    ]
    assert truth.M_alpha < 0 < truth.frequency()
    assert np.corrcoef(q_dot, by_model)[0, 1] > 0.98


def test_the_same_seed_gives_the_same_flight(plain):
    again = list(flight_of(CESSNA).samples())
    np.testing.assert_array_equal(channel(again, "q"), channel(plain, "q"))


@pytest.mark.parametrize(
    ("name", "sizes", "touched"),
    [
        ("transport_delay", {"delay_s": 0.1}, {"alpha", "q", "a_z", "theta"}),
        ("actuator_lag", {"lag_s": 0.1}, {"alpha", "q", "a_z", "theta"}),
        ("gust", {"amplitude_m_s": 3.0, "share": 1.0}, {"alpha", "q", "a_z", "theta"}),
        ("alpha_vane_offset", {"arm_m": 2.0}, {"alpha"}),
        ("pitch_rate_skew", {"skew_s": 0.05}, {"q"}),
        ("accelerometer_offset", {"arm_m": 1.0}, {"a_z"}),
    ],
)
def test_effects_act_on_its_actuators_air_sensors_and_timing(plain, name, sizes, touched):
    changed = list(flight_of(replace(CESSNA, effects={name: sizes})).samples())
    part = [i for i, sample in enumerate(plain) if sample.flying]
    seen = set()
    for quantity in ("alpha", "q", "a_z", "theta"):
        before, after = channel(plain, quantity)[part], channel(changed, quantity)[part]
        if np.abs(after - before).max() > 0.02 * np.ptp(before):
            seen.add(quantity)
    assert seen == touched


def test_effects_of_the_airframe_are_refused_by_name():
    with pytest.raises(ScenarioError, match=r"effects\.nonlinear_lift: needs a nonlinear aircraft"):
        flight_of(replace(CESSNA, effects={"nonlinear_lift": {}}))


def test_an_aircraft_that_jsbsim_lacks_is_refused_by_name():
    with pytest.raises(ScenarioError, match="JSBSim has no 'sopwith'"):
        JsbsimAircraft("sopwith", 50.0, 1000.0, 0.002)
