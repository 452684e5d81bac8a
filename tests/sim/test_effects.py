"""Every named effect as a component: invisible when small, gross when large, and where it belongs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.effects.actuator import Backlash, Deadband, RateLimit
from sim.effects.catalogue import CATALOGUE
from sim.effects.fitting import KINDS, flight_of
from sim.effects.outside import OUTSIDE
from sim.flight import Flight
from sim.loading import ScenarioError
from sim.scenario import Maneuver, Noise, Scenario
from sim.servo import FirstOrderServo, TransportDelay

CONTRACT = [
    "actuator_lag",
    "actuator_rate_limit",
    "actuator_backlash",
    "actuator_deadband",
    "transport_delay",
    "elevator_nonlinearity",
    "nonlinear_pitching_moment",
    "thrust_moment",
    "cg_shift",
    "alpha_dot",
    "nonlinear_lift",
    "unsteady_lift",
    "mass_change",
    "icing",
    "airspeed_variation",
    "ground_effect",
    "turbulence",
    "gust",
    "alpha_lag",
    "alpha_scale",
    "alpha_bias",
    "alpha_vane_offset",
    "pitch_rate_bias",
    "pitch_rate_scale",
    "structural_mode",
    "accelerometer_offset",
    "alpha_skew",
    "pitch_rate_skew",
    "accelerometer_skew",
    "attitude_skew",
]

CHANNELS = ("alpha", "q", "a_z", "theta", "airspeed")
PLAIN = Scenario(
    maneuvers=tuple(Maneuver(name, throttle_change=0.15) for name in ("3211", "rev")),
    noise=Noise(),
    speed="held",
    height_m=8.0,
    lead_in_s=2.0,
    gap_s=4.0,
    free_s=2.0,
)

SMALL = {
    "actuator_lag": {"lag_s": 1e-5},
    "actuator_rate_limit": {"rate_rad_s": 100.0},
    "actuator_backlash": {"half_width_rad": 1e-7},
    "actuator_deadband": {"half_width_rad": 1e-7},
    "transport_delay": {"delay_s": 1e-5},
    "elevator_nonlinearity": {"cm_delta_e3": 1e-3},
    "nonlinear_pitching_moment": {"cm_alpha2": 1e-4, "cm_alpha3": 1e-3},
    "thrust_moment": {"arm_m": 1e-5},
    "cg_shift": {"aft_m": 1e-6},
    "alpha_dot": {"cm_alpha_dot": 1e-3},
    "nonlinear_lift": {"cl_alpha2": 1e-3},
    "unsteady_lift": {"share": 1e-4},
    "mass_change": {"share": 1e-5},
    "icing": {"severity": 1e-5},
    "ground_effect": {"lift": 1e-5, "moment": 1e-7},
    "turbulence": {"sigma_w_m_s": 1e-6},
    "gust": {"amplitude_m_s": 1e-5},
    "alpha_lag": {"lag_s": 1e-5},
    "alpha_scale": {"scale": 1e-5},
    "alpha_bias": {"bias_rad": 1e-6},
    "alpha_vane_offset": {"arm_m": 1e-4},
    "pitch_rate_bias": {"bias_rad_s": 1e-6},
    "pitch_rate_scale": {"scale": 1e-5},
    "structural_mode": {"gain": 1e-5},
    "accelerometer_offset": {"arm_m": 1e-5},
    "alpha_skew": {"skew_s": 1e-5},
    "pitch_rate_skew": {"skew_s": 1e-5},
    "accelerometer_skew": {"skew_s": 1e-5},
    "attitude_skew": {"skew_s": 1e-5},
}


def readings(scenario):
    """Largest-signal-relative readings while manoeuvres are flown, (channel, time)."""
    flown = [sample for sample in flight_of(scenario).samples() if sample.flying]
    return {name: np.array([getattr(sample.reading, name) for sample in flown]) for name in CHANNELS}


@pytest.fixture(scope="module")
def plain():
    return readings(PLAIN)


def difference(scenario, plain):
    """Per channel: rms of the difference over the rms of the plain signal about its mean."""
    changed = readings(scenario)
    return {
        name: float(np.sqrt(np.mean((changed[name] - plain[name]) ** 2)) / max(plain[name].std(), 1e-3))
        for name in CHANNELS
    }


def test_every_effect_of_the_contract_is_in_the_catalogue_and_nothing_else():
    assert sorted(CATALOGUE) == sorted(CONTRACT)


def test_at_least_ten_kinds_lie_outside_the_catalogue():
    assert len(OUTSIDE) >= 10
    assert not set(OUTSIDE) & set(CATALOGUE)


@pytest.mark.parametrize("name", sorted(KINDS))
def test_an_effect_of_moderate_size_is_seen(name, plain):
    assert max(difference(replace(PLAIN, effects={name: {}}), plain).values()) > 0.01


def test_tiny_effects_are_invisible_even_all_together(plain):
    def seen(effects):
        return max(difference(replace(PLAIN, effects=effects), plain).values())

    assert set(SMALL) == set(CATALOGUE) - {"airspeed_variation"}
    # Only where all together are seen does each fly alone, to be named.
    assert seen(SMALL) < 0.003, [name for name in SMALL if seen({name: SMALL[name]}) >= 0.003]


@pytest.mark.parametrize(
    ("name", "touched"),
    [
        ("alpha_lag", {"alpha"}),
        ("alpha_scale", {"alpha"}),
        ("alpha_vane_offset", {"alpha"}),
        ("alpha_skew", {"alpha"}),
        ("pitch_rate_scale", {"q"}),
        ("structural_mode", {"q"}),
        ("accelerometer_offset", {"a_z"}),
        ("accelerometer_skew", {"a_z"}),
        ("attitude_skew", {"theta"}),
    ],
)
def test_an_instruments_effect_touches_that_instrument_alone(name, touched, plain):
    seen = difference(replace(PLAIN, effects={name: {}}), plain)
    assert {channel for channel, size in seen.items() if size > 1e-9} == touched


def test_a_late_message_takes_attitude_and_pitch_rate_with_it(plain):
    seen = difference(replace(PLAIN, effects={"attitude_skew": {"with_pitch_rate": 1.0}}), plain)
    assert {channel for channel, size in seen.items() if size > 1e-9} == {"theta", "q"}


def test_effects_combine(plain):
    one = difference(replace(PLAIN, effects={"alpha_scale": {}}), plain)
    both = difference(replace(PLAIN, effects={"alpha_scale": {}, "pitch_rate_scale": {}}), plain)
    assert both["alpha"] == pytest.approx(one["alpha"])
    assert both["q"] > 0.05


def test_a_positive_skew_shows_the_past_and_a_negative_one_the_future():
    def q(skew):
        effects = {"pitch_rate_skew": {"skew_s": skew}} if skew else {}
        samples = flight_of(replace(PLAIN, effects=effects)).samples()
        return np.array([sample.reading.q for sample in samples])

    now, late, early = q(0.0), q(0.06), q(-0.06)
    np.testing.assert_allclose(late[50:500], now[47:497], atol=1e-12)
    np.testing.assert_allclose(early[50:500], now[53:503], atol=1e-12)


def test_an_unknown_effect_and_an_unknown_size_are_both_named():
    scenario = Scenario(effects={"wobble": {}, "alpha_lag": {"lag": 1.0}})
    with pytest.raises(ScenarioError) as caught:
        flight_of(scenario)
    text = "\n".join(caught.value.problems)
    assert "effects.wobble: unknown effect" in text
    assert "effects.alpha_lag.lag: unknown parameter, choose from lag_s" in text


def test_the_linear_aircraft_refuses_effects_of_the_airframe_by_name():
    with pytest.raises(ScenarioError, match=r"effects\.icing: needs a nonlinear aircraft"):
        flight_of(Scenario(aircraft="linear", effects={"icing": {}}))


def test_the_aircraft_is_trimmed_with_the_effect_present():
    scenario = replace(PLAIN, effects={"ground_effect": {}, "nonlinear_lift": {}}, maneuvers=())
    samples = list(Flight(scenario, engine=flight_of(scenario).engine).samples())
    assert samples[-1].motion.height == pytest.approx(8.0, abs=0.3)


def ramp(mechanism, slope, dt=0.002, count=500):
    mechanism.reset(0.0)
    return np.array([mechanism.step(slope * dt * i, dt) for i in range(1, count + 1)])


def test_a_first_order_servo_trails_a_ramp_by_its_lag():
    lag, slope = 0.05, 0.3
    times = 0.002 * np.arange(1, 501)
    exact = slope * (times - lag + lag * np.exp(-times / lag))
    np.testing.assert_allclose(ramp(FirstOrderServo(lag), slope), exact, atol=1e-12)


def test_a_transport_delay_gives_the_past_exactly():
    out = ramp(TransportDelay(0.0513), 1.0)
    times = 0.002 * np.arange(1, 501)
    np.testing.assert_allclose(out[30:], times[30:] - 0.0513, atol=1e-12)


def test_a_rate_limit_is_never_exceeded_and_reached():
    out = ramp(RateLimit(0.5), 3.0)
    assert np.diff(out).max() == pytest.approx(0.5 * 0.002)


def test_backlash_loses_motion_on_every_reversal():
    play = Backlash(0.01)
    play.reset(0.0)
    up = [play.step(value, 0.002) for value in np.linspace(0.0, 0.1, 50)]
    down = [play.step(value, 0.002) for value in np.linspace(0.1, 0.0, 50)]
    assert up[-1] == pytest.approx(0.09)
    assert down[-1] == pytest.approx(0.01)


def test_a_deadband_lies_around_neutral():
    band = Deadband(0.01, 0.02)
    assert [band.step(value, 0.002) for value in (0.02, 0.029, 0.04, 0.0)] == pytest.approx(
        [0.02, 0.02, 0.03, 0.01]
    )


def test_a_deadband_may_move_with_the_trim():
    band = Deadband(0.01, 0.0, above_trim_rad=0.005)
    while band.neutral == 0.0:
        band.step(0.04, 0.1)
    # Later steps are shorter than a trim is held.
    assert [band.step(value, 0.1) for value in (0.04, 0.056, 0.02)] == pytest.approx([0.045, 0.046, 0.03])


def test_turbulence_has_the_strength_asked_for():
    scenario = replace(
        PLAIN, maneuvers=(Maneuver("none", free_s=200.0),), effects={"turbulence": {"sigma_w_m_s": 0.5}}
    )
    up = np.array([sample.motion.gust_up for sample in flight_of(scenario).samples()])
    assert up.std() == pytest.approx(0.5, rel=0.12)


def test_the_vane_meets_gusts_that_the_derived_angle_does_not():
    scenario = replace(PLAIN, effects={"gust": {"share": 1.0}})
    samples = [s for s in flight_of(scenario).samples() if abs(s.motion.gust_up) > 1.0]
    assert samples
    for sample in samples:
        expected = sample.motion.alpha + math.atan(sample.motion.gust_up / sample.motion.airspeed)
        assert sample.reading.alpha == pytest.approx(expected, abs=1e-3)
