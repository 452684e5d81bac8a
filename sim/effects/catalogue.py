"""Every named effect as a physical component of the aircraft.

A positive skew means late data. A change between manoeuvres begins halfway through the flight, unless
``at_s`` (seconds since the log began) gives the time. ``ramp_s`` is the duration of a gradual change.
"""

import math
from collections.abc import Iterable

import numpy as np

from ..atmosphere import DrydenTurbulence
from ..fittings import Turbulent
from ..servo import FirstOrderServo, Mechanism, SecondOrderServo, TransportDelay
from .actuator import Backlash, Deadband, RateLimit
from .air import Gusts
from .changes import EngineSurge, FieldChange, Onset
from .instruments import BendingMode, Lagging, Leading, Scaled, VaneAhead
from .kit import Kind, Kit, Sizes


def _delay(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.mechanisms.insert(0, TransportDelay(sizes["delay_s"]))


def _lag(kit: Kit, sizes: Sizes) -> None:
    lag_s, damping = sizes["lag_s"], sizes["damping"]
    if damping > 0.0 and lag_s > 0.0:
        # Both lag equally behind a ramp.
        servo: Mechanism = SecondOrderServo(damping / (math.pi * lag_s), damping)
    elif lag_s > 0.0:
        servo = FirstOrderServo(lag_s)
    else:
        return
    kit.fittings.mechanisms.append(servo)


def _rate_limit(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.mechanisms.append(RateLimit(sizes["rate_rad_s"]))


def _backlash(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.mechanisms.append(Backlash(sizes["half_width_rad"]))


def _deadband(kit: Kit, sizes: Sizes) -> None:
    above = sizes["neutral_rad"]
    moves = sizes["about_trim"] > 0.0
    kit.fittings.mechanisms.append(
        Deadband(sizes["half_width_rad"], kit.trim.elevator + above, above if moves else None)
    )


def _onset(kit: Kit, sizes: Sizes) -> Onset:
    return Onset(kit.middle_s if math.isnan(sizes["at_s"]) else sizes["at_s"], sizes["ramp_s"])


def _cg(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.plant.append(FieldChange(_onset(kit, sizes), {}, {"cg_aft": sizes["aft_m"]}))


def _mass(kit: Kit, sizes: Sizes) -> None:
    change = {"mass": sizes["share"], "iyy": sizes["share"]}
    kit.fittings.plant.append(FieldChange(_onset(kit, sizes), change, {}))


def _ice(kit: Kit, sizes: Sizes) -> None:
    """Reduce lift slope, stability and control power, and add drag (shares after Bragg's η model)."""
    severity = sizes["severity"]
    change = {"cl_alpha": -0.5, "cl_delta_e": -0.5, "cm_alpha": -0.5, "cm_delta_e": -0.5, "cd_0": 2.0}
    factors = {name: share * severity for name, share in change.items()}
    kit.fittings.plant.append(FieldChange(_onset(kit, sizes), factors, {}))


def _surge(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.plant.append(EngineSurge(sizes["share"], sizes["period_s"]))


def _turbulence(kit: Kit, sizes: Sizes) -> None:
    generator = np.random.default_rng([kit.seed, 31])
    kit.fittings.air.append(Turbulent(DrydenTurbulence(sizes["sigma_w_m_s"], sizes["length_m"], generator)))


def _gust(kit: Kit, sizes: Sizes) -> None:
    generator = np.random.default_rng([kit.seed, 32])
    times = tuple(
        p.start_s + float(generator.uniform(0.0, 0.7 * (p.end_s - p.start_s)))
        for p in kit.planned
        if generator.random() < sizes["share"]
    )
    kit.fittings.air.append(Gusts(sizes["amplitude_m_s"], sizes["length_m"], times))


def _vane_lag(kit: Kit, sizes: Sizes) -> None:
    lag_s = sizes["lag_s"]
    if lag_s > 0.0:
        kit.fittings.sensors.append(Lagging(lag_s))
    elif lag_s < 0.0:
        kit.fittings.sensors.append(Leading(-lag_s))


def _alpha_scale(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(Scaled("alpha", scale=sizes["scale"]))


def _alpha_bias(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(Scaled("alpha", bias=sizes["bias_rad"]))


def _vane_arm(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(VaneAhead(sizes["arm_m"]))


def _q_bias(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(Scaled("q", bias=sizes["bias_rad_s"]))


def _q_scale(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(Scaled("q", scale=sizes["scale"]))


def _bending(kit: Kit, sizes: Sizes) -> None:
    if sizes["frequency_hz"] <= 0.0:
        return
    mode = BendingMode(
        sizes["frequency_hz"], sizes["damping"], sizes["gain"], sizes["displacement_gain"],
        sizes["with_attitude"] > 0.0,
    )  # fmt: skip
    kit.fittings.sensors.append(mode)


def _imu_arm(kit: Kit, sizes: Sizes) -> None:
    kit.fittings.accelerometer_arm_m += sizes["arm_m"]


def _skew(*channels: str) -> Kind:
    def fit(kit: Kit, sizes: Sizes) -> None:
        _late(kit, channels, sizes["skew_s"])

    return Kind("timing", {"skew_s": 0.04}, fit)


def _late(kit: Kit, channels: Iterable[str], skew_s: float) -> None:
    for channel in channels:
        kit.fittings.skews[channel] = kit.fittings.skews.get(channel, 0.0) + skew_s


def _attitude_late(kit: Kit, sizes: Sizes) -> None:
    """Delay the attitude alone, or the message with attitude and pitch rate."""
    _late(kit, ("theta", "q") if sizes["with_pitch_rate"] else ("theta",), sizes["skew_s"])


_ONSET = {"at_s": math.nan, "ramp_s": 0.0}

CATALOGUE: dict[str, Kind] = {
    "actuator_lag": Kind("input", {"lag_s": 0.06, "damping": 0.0}, _lag),
    "actuator_rate_limit": Kind("input", {"rate_rad_s": 0.7}, _rate_limit),
    "actuator_backlash": Kind("input", {"half_width_rad": 0.007}, _backlash),
    "actuator_deadband": Kind(
        "input", {"half_width_rad": 0.007, "neutral_rad": 0.0, "about_trim": 0.0}, _deadband
    ),
    "transport_delay": Kind("input", {"delay_s": 0.06}, _delay),
    "elevator_nonlinearity": Kind(
        "moment_equation",
        {"cm_delta_e2": 0.0, "cm_delta_e3": 150.0},
        airframe=lambda s: {"cm_delta_e2": s["cm_delta_e2"], "cm_delta_e3": s["cm_delta_e3"]},
    ),
    "nonlinear_pitching_moment": Kind(
        "moment_equation",
        {"cm_alpha2": 3.0, "cm_alpha3": -60.0},
        airframe=lambda s: {"cm_alpha2": s["cm_alpha2"], "cm_alpha3": s["cm_alpha3"]},
    ),
    "thrust_moment": Kind("moment_equation", {"arm_m": 0.15}, airframe=lambda s: {"thrust_arm": s["arm_m"]}),
    "cg_shift": Kind("moment_equation", {"aft_m": 0.015, **_ONSET}, _cg, nonlinear_only=True),
    "alpha_dot": Kind(
        "moment_equation", {"cm_alpha_dot": -6.0}, airframe=lambda s: {"cm_alpha_dot": s["cm_alpha_dot"]}
    ),
    "nonlinear_lift": Kind(
        "force_equation",
        {"cl_alpha2": -15.0, "cl_alpha3": 0.0, "stall_alpha_rad": 0.0, "stall_sharpness": 30.0},
        airframe=lambda s: {
            "cl_alpha2": s["cl_alpha2"],
            "cl_alpha3": s["cl_alpha3"],
            "stall_alpha": s["stall_alpha_rad"],
            "stall_sharpness": s["stall_sharpness"],
        },
    ),
    "unsteady_lift": Kind(
        "force_equation",
        {"share": 0.4, "lag_s": 0.15},
        airframe=lambda s: {"unsteady_share": s["share"], "unsteady_lag": s["lag_s"]},
    ),
    "mass_change": Kind("force_equation", {"share": -0.15, **_ONSET}, _mass, nonlinear_only=True),
    "icing": Kind("force_equation", {"severity": 0.4, **_ONSET}, _ice, nonlinear_only=True),
    "airspeed_variation": Kind(
        "force_equation",
        {"share": 0.6, "period_s": 23.0},
        _surge,
        airframe=lambda s: {"speed_held": 0.0},
        nonlinear_only=True,
    ),
    "ground_effect": Kind(
        "force_equation",
        {"lift": 0.25, "moment": -0.01},
        airframe=lambda s: {"ground_lift": s["lift"], "ground_moment": s["moment"]},
    ),
    "turbulence": Kind("air", {"sigma_w_m_s": 0.5, "length_m": 60.0}, _turbulence),
    "gust": Kind("air", {"amplitude_m_s": 2.0, "length_m": 25.0, "share": 0.7}, _gust),
    "alpha_lag": Kind("alpha_sensor", {"lag_s": 0.05}, _vane_lag),
    "alpha_scale": Kind("alpha_sensor", {"scale": 0.1}, _alpha_scale),
    "alpha_bias": Kind("alpha_sensor", {"bias_rad": 0.02}, _alpha_bias),
    "alpha_vane_offset": Kind("alpha_sensor", {"arm_m": 0.6}, _vane_arm),
    "pitch_rate_bias": Kind("pitch_rate_sensor", {"bias_rad_s": 0.01}, _q_bias),
    "pitch_rate_scale": Kind("pitch_rate_sensor", {"scale": 0.1}, _q_scale),
    "structural_mode": Kind(
        "pitch_rate_sensor",
        {"frequency_hz": 4.0, "damping": 0.04, "gain": 2.0, "displacement_gain": 0.0, "with_attitude": 0.0},
        _bending,
    ),
    "accelerometer_offset": Kind("accelerometer", {"arm_m": 0.2}, _imu_arm),
    "alpha_skew": _skew("alpha"),
    "pitch_rate_skew": _skew("q"),
    "accelerometer_skew": _skew("a_z", "a_x"),
    "attitude_skew": Kind("timing", {"skew_s": 0.04, "with_pitch_rate": 0.0}, _attitude_late),
}
"""Component of each effect of the gap diagnosis, by the effect's name."""
