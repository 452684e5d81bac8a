"""The contract's thirty effects, each as a physical component of this generator."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from .air import cosine_gust, dryden
from .flight import STEP_S
from .instruments import DEG, filtered, ringing, shifted
from .plan import Wishes
from .setup import Applied, Effect, Setup, both_gyros, change_at, moments, named_parameters, only, sign


def _lag(setup: Setup, size: float, rng: Generator) -> Applied:
    return setup.steering(added_lag_s=size), named_parameters(lag_s=size)


def _rate(setup: Setup, size: float, rng: Generator) -> Applied:
    # The larger the size, the slower the servo: relative to the fastest hand of this flight.
    fastest = float(np.max(np.abs(np.diff(setup.plan.stick)))) / STEP_S
    return setup.steering(rate_limit=fastest / size), named_parameters(rate_rad_s=fastest / size)


def _play(setup: Setup, size: float, rng: Generator) -> Applied:
    return setup.steering(play=size), named_parameters(half_width_rad=size)


def _deadband(setup: Setup, size: float, rng: Generator) -> Applied:
    neutral = float(np.mean([trimmed.delta for trimmed in setup.plan.trims]))
    return setup.steering(deadband=size, neutral=neutral), named_parameters(half_width_rad=size)


def _delay(setup: Setup, size: float, rng: Generator) -> Applied:
    return setup.steering(added_delay_s=size), named_parameters(delay_s=size)


def _bent_elevator(setup: Setup, size: float, rng: Generator) -> Applied:
    reach = max(m.amplitude_rad for m in setup.plan.maneuvers)
    square, cube = sign(rng) * size * float(rng.uniform(0.0, 1.0)) / reach, -size / reach**2
    trimmed = setup.plan.trims[0].delta
    return setup.fault(delta_0=trimmed, flap_square=square, flap_cube=cube), named_parameters(
        flap_square_per_rad=square, flap_cube_per_rad2=cube
    )


def _bent_moment(setup: Setup, size: float, rng: Generator) -> Applied:
    share = float(rng.uniform(0.3, 1.0)) * sign(rng)
    scale = _moment_slope(setup) * size
    square, cube = scale * share / 0.06, scale * sign(rng) / 0.06**2
    return setup.fault(
        alpha_0=setup.plan.trims[0].alpha, moment_square=square, moment_cube=cube
    ), named_parameters(cm_square_per_rad2=square, cm_cube_per_rad3=cube)


def _moment_slope(setup: Setup) -> float:
    """Size of C_m_alpha [1/rad]."""
    body, model = setup.plan.shape, setup.plan.model
    pressure = 0.5 * body.density * body.speed_0**2
    return abs(model["M_alpha"]) * body.inertia / (pressure * body.area * body.chord)


def _thrust_arm(setup: Setup, size: float, rng: Generator) -> Applied:
    arm = sign(rng) * size * setup.plan.shape.chord
    return setup.fault(thrust_arm=arm), named_parameters(thrust_line_below_m=arm)


def _cg(setup: Setup, size: float, rng: Generator) -> Applied:
    shift = sign(rng) * size * setup.plan.shape.chord
    return setup.surrounded("cg", shift * _ramp(setup, rng)), named_parameters(aft_m=shift)


def _ramp(setup: Setup, rng: Generator) -> np.ndarray:
    """From zero to one: over the whole flight, or within seconds between two manoeuvres."""
    time = setup.plan.time
    if rng.random() < 0.5:
        return time / time[-1]
    return np.clip((time - change_at(setup, rng)) / 2.0 + 0.5, 0.0, 1.0)


def _alpha_dot(setup: Setup, size: float, rng: Generator) -> Applied:
    body, model = setup.plan.shape, setup.plan.model
    pressure = 0.5 * body.density * body.speed_0**2
    natural = abs(model["M_q"]) * body.inertia * 2.0 * body.speed_0 / (pressure * body.area * body.chord**2)
    added = sign(rng) * size * natural
    return setup.fault(alpha_dot=added), named_parameters(cm_alpha_dot=added)


def _kinked_lift(setup: Setup, size: float, rng: Generator) -> Applied:
    highest = max(trimmed.alpha for trimmed in setup.plan.trims)
    at = highest + float(rng.uniform(0.0, 1.2)) * DEG
    return setup.fault(kink=size, kink_at=at), named_parameters(slope_lost=size, above_rad=at)


def _wake(setup: Setup, size: float, rng: Generator) -> Applied:
    chords = (
        float(rng.uniform(0.6, 1.6))
        * setup.plan.shape.speed_0
        / (setup.plan.own_rad_s * setup.plan.shape.chord)
    )
    lag = chords * setup.plan.shape.chord / setup.plan.shape.speed_0
    return setup.fault(wake_share=size, wake_chords=chords), named_parameters(share=size, wake_lag_s=lag)


def _mass(setup: Setup, size: float, rng: Generator) -> Applied:
    share = sign(rng) * size
    return setup.surrounded("weight", share * _ramp(setup, rng)), named_parameters(share=share)


def _ice(setup: Setup, size: float, rng: Generator) -> Applied:
    grown = np.clip((setup.plan.time - change_at(setup, rng)) / float(rng.uniform(2.0, 10.0)) + 0.5, 0.0, 1.0)
    return setup.surrounded("ice", size * grown), named_parameters(lift_lost=size)


def _speed(setup: Setup, size: float, rng: Generator) -> Applied:
    power = sign(rng) * size
    return setup.fault(wing_power=power, tail_power=power), named_parameters(power=power)


def _ground(setup: Setup, size: float, rng: Generator) -> Applied:
    low = min(m.height_m for m in setup.plan.maneuvers)
    return setup.fault(ground=size), named_parameters(strength=size, lowest_m=low)


def scale_of_turbulence(setup: Setup) -> float:
    """Dryden's length [m]: half the height, within what fits a manoeuvre."""
    return float(np.clip(0.5 * setup.plan.aircraft.height_m, 60.0, 300.0))


def turbulent(setup: Setup, rms: float, rng: Generator) -> Setup:
    """With vertical and horizontal gusts."""
    n, v, scale = setup.plan.steps, setup.plan.shape.speed_0, scale_of_turbulence(setup)
    up = setup.surrounded("updraft", dryden(n, rms, scale, v, rng))
    return up.surrounded("headwind", 0.7 * dryden(n, rms, 2.0 * scale, v, rng))


def _turbulence(setup: Setup, size: float, rng: Generator) -> Applied:
    rms = size * setup.plan.shape.speed_0
    return turbulent(setup, rms, rng), named_parameters(rms_m_s=rms)


def _gust(setup: Setup, size: float, rng: Generator) -> Applied:
    peak, series = size * setup.plan.shape.speed_0, np.zeros(setup.plan.steps)
    for start in moments(setup, rng, int(rng.integers(2, 5))):
        length = float(rng.uniform(2.5, 6.0)) / setup.plan.own_rad_s
        series += cosine_gust(series.size, start + float(rng.uniform(-0.3, 1.5)), length, sign(rng) * peak)
    return setup.surrounded("updraft", series), named_parameters(peak_m_s=peak)


def _alpha_lag(setup: Setup, size: float, rng: Generator) -> Applied:
    return setup.seen(only("alpha", lambda t, x, c: filtered(x, size))), named_parameters(lag_s=size)


def _alpha_scale(setup: Setup, size: float, rng: Generator) -> Applied:
    part = sign(rng) * size
    return setup.seen(only("alpha", lambda t, x, c: (1.0 + part) * x)), named_parameters(scale=part)


def _alpha_bias(setup: Setup, size: float, rng: Generator) -> Applied:
    bias = sign(rng) * size
    return setup.seen(only("alpha", lambda t, x, c: x + bias)), named_parameters(bias_rad=bias)


def _vane_place(setup: Setup, size: float, rng: Generator) -> Applied:
    arm = sign(rng) * size * setup.plan.aircraft.tail_arm_m
    return setup.seen(only("alpha", lambda t, x, c: x - arm * c["q"] / c["airspeed"])), named_parameters(
        arm_m=arm
    )


def _rate_bias(setup: Setup, size: float, rng: Generator) -> Applied:
    bias = sign(rng) * size
    return setup.seen(*both_gyros(lambda x: x + bias)), named_parameters(bias_rad_s=bias)


def _rate_scale(setup: Setup, size: float, rng: Generator) -> Applied:
    part = sign(rng) * size
    return setup.seen(*both_gyros(lambda x: (1.0 + part) * x)), named_parameters(scale=part)


def _structure(setup: Setup, size: float, rng: Generator) -> Applied:
    own = 2.0 * np.pi * float(np.clip(rng.uniform(2.5, 4.5) * setup.plan.own_rad_s / (2.0 * np.pi), 2.0, 8.0))
    damping = float(rng.uniform(0.03, 0.08))

    # As large a rate, at a share of one, as the short period's answer to the same deflection.
    gain = size * abs(setup.plan.model["M_delta_e"]) / (setup.plan.own_rad_s * own)

    def bent(t, x, c):  # type: ignore[no-untyped-def]
        return x + gain * np.gradient(ringing(c["surface"], own, damping), STEP_S)

    return setup.seen(only("q", bent), only("imu_q", bent)), named_parameters(
        own_rad_s=own, damping=damping, gain=gain
    )


def _imu_place(setup: Setup, size: float, rng: Generator) -> Applied:
    arm = sign(rng) * size * setup.plan.shape.chord
    kit = replace(setup.kit, imu_arm_m=setup.kit.imu_arm_m + arm)
    return replace(setup, kit=kit), named_parameters(arm_m=arm)


def _late(*channels: str):  # type: ignore[no-untyped-def]
    def apply(setup: Setup, size: float, rng: Generator) -> Applied:
        late = size * (1.0 if rng.random() < 0.75 else -1.0)
        changes = (only(name, lambda t, x, c: shifted(t, x, late)) for name in channels)
        return setup.seen(*changes), named_parameters(skew_s=late)

    return apply


NAMED = {
    "actuator_lag": Effect("input", 0.02, 0.15, 0.3, _lag),
    "actuator_rate_limit": Effect("input", 1.2, 6.0, 12.0, _rate),
    "actuator_backlash": Effect("input", 0.1 * DEG, 1.2 * DEG, 2.5 * DEG, _play),
    "actuator_deadband": Effect("input", 0.15 * DEG, 1.2 * DEG, 2.5 * DEG, _deadband),
    # A shorter delay is that of telemetry with stamps 20 to 50 ms apart.
    "transport_delay": Effect("input", 0.04, 0.15, 0.3, _delay),
    "elevator_nonlinearity": Effect("moment_equation", 0.08, 0.35, 0.5, _bent_elevator),
    "nonlinear_pitching_moment": Effect("moment_equation", 0.1, 0.5, 0.8, _bent_moment),
    "thrust_moment": Effect("moment_equation", 0.05, 0.4, 1.0, _thrust_arm, wishes=Wishes(power=0.5)),
    "cg_shift": Effect("moment_equation", 0.015, 0.06, 0.1, _cg),
    "alpha_dot": Effect("moment_equation", 0.3, 1.2, 2.0, _alpha_dot, in_turbulence=True),
    "nonlinear_lift": Effect("force_equation", 0.1, 0.45, 0.7, _kinked_lift),
    "unsteady_lift": Effect("force_equation", 0.15, 0.5, 0.7, _wake),
    "mass_change": Effect("force_equation", 0.06, 0.25, 0.35, _mass),
    "icing": Effect("force_equation", 0.05, 0.25, 0.35, _ice),
    "airspeed_variation": Effect(
        "force_equation", 0.25, 1.2, 2.0, _speed, wishes=Wishes(speeds=(0.85, 1.17))
    ),
    "ground_effect": Effect("force_equation", 0.5, 1.5, 2.0, _ground, wishes=Wishes(near_ground=True)),
    "turbulence": Effect("air", 0.004, 0.02, 0.04, _turbulence),
    "gust": Effect("air", 0.015, 0.06, 0.1, _gust),
    "alpha_lag": Effect("alpha_sensor", 0.02, 0.2, 0.4, _alpha_lag, needs_boom=True),
    "alpha_scale": Effect("alpha_sensor", 0.03, 0.25, 0.4, _alpha_scale, needs_boom=True),
    "alpha_bias": Effect(
        "alpha_sensor", 0.3 * DEG, 2.0 * DEG, 3.0 * DEG, _alpha_bias, dynamic=False, needs_boom=True
    ),
    "alpha_vane_offset": Effect("alpha_sensor", 0.15, 1.5, 3.0, _vane_place, needs_boom=True),
    "pitch_rate_bias": Effect(
        "pitch_rate_sensor", 0.15 * DEG, 1.5 * DEG, 2.0 * DEG, _rate_bias, dynamic=False
    ),
    "pitch_rate_scale": Effect("pitch_rate_sensor", 0.03, 0.25, 0.4, _rate_scale),
    "structural_mode": Effect("pitch_rate_sensor", 0.05, 0.4, 0.8, _structure),
    "accelerometer_offset": Effect("accelerometer", 0.15, 1.5, 3.0, _imu_place),
    "alpha_skew": Effect("timing", 0.02, 0.15, 0.3, _late("alpha"), needs_boom=True),
    "pitch_rate_skew": Effect("timing", 0.012, 0.12, 0.25, _late("q")),
    "accelerometer_skew": Effect("timing", 0.012, 0.12, 0.25, _late("a_x", "a_z", "imu_q")),
    "attitude_skew": Effect("timing", 0.015, 0.15, 0.3, _late("theta")),
}
