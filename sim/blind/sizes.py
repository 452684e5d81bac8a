"""Sizes of effects, from hardly visible to gross, relative to the aircraft."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Draw = Callable[["Scale", np.random.Generator], dict[str, float]]


@dataclass(frozen=True)
class Scale:
    """Scales of small and large sizes for one aircraft."""

    length: float
    """Length scale relative to the small UAV. Arms and gust lengths grow with it."""
    chord: float
    amplitude: float
    """Elevator amplitude of the test inputs, rad."""
    swing: float
    """Amplitude of the angle of attack in the response, rad."""
    speed: float
    """Air speed relative to 25 m/s. Gusts are scaled to a constant angle."""
    cl_alpha: float = 4.9
    cm_alpha: float = -0.75
    cm_delta_e: float = -1.15


def _log(generator: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(generator.uniform(math.log(low), math.log(high))))


def _signed(generator: np.random.Generator, low: float, high: float) -> float:
    return _log(generator, low, high) * (1.0 if generator.random() < 0.5 else -1.0)


def _one(name: str, low: float, high: float, *, signed: bool = False, by: str = "") -> Draw:
    """Draw one size between two limits, times a field of the scale."""

    def draw(scale: Scale, generator: np.random.Generator) -> dict[str, float]:
        value = (_signed if signed else _log)(generator, low, high)
        return {name: value * (getattr(scale, by) if by else 1.0)}

    return draw


def _elevator(scale: Scale, g: np.random.Generator) -> dict[str, float]:
    power, reach = scale.cm_delta_e, scale.amplitude
    if g.random() < 0.5:
        return {"cm_delta_e2": 0.0, "cm_delta_e3": -_log(g, 0.1, 0.5) * power / reach**2}
    return {"cm_delta_e2": _signed(g, 0.08, 0.4) * power / reach, "cm_delta_e3": 0.0}


def _moment(scale: Scale, g: np.random.Generator) -> dict[str, float]:
    return {
        "cm_alpha2": _signed(g, 0.08, 0.45) * scale.cm_alpha / scale.swing,
        "cm_alpha3": float(g.uniform(0.0, 0.3)) * scale.cm_alpha / scale.swing**2,
    }


def _lift(scale: Scale, g: np.random.Generator) -> dict[str, float]:
    if g.random() < 0.4:
        return {
            "cl_alpha2": 0.0,
            "stall_alpha_rad": _log(g, 0.05, 0.12),
            "stall_sharpness": _log(g, 25.0, 60.0),
        }
    return {"cl_alpha2": -_log(g, 0.1, 0.6) * scale.cl_alpha / scale.swing}


def _pair(first: Draw, second: Draw) -> Draw:
    return lambda scale, g: {**first(scale, g), **second(scale, g)}


def _mode(scale: Scale, g: np.random.Generator) -> dict[str, float]:
    # In half of all aircraft the attitude is integrated from that gyro.
    return {
        "frequency_hz": _log(g, 2.2, 9.0),
        "damping": _log(g, 0.02, 0.1),
        "gain": _log(g, 0.25, 4.0),
        "with_attitude": float(g.random() < 0.5),
    }


_SKEW = _one("skew_s", 0.012, 0.12, signed=True)

INSIDE: dict[str, Draw] = {
    "actuator_lag": _one("lag_s", 0.015, 0.12),
    "actuator_rate_limit": _one("rate_rad_s", 0.25, 1.6),
    "actuator_backlash": _one("half_width_rad", 0.08, 0.45, by="amplitude"),
    "actuator_deadband": _one("half_width_rad", 0.08, 0.45, by="amplitude"),
    # A shorter delay is that of any telemetry.
    "transport_delay": _one("delay_s", 0.03, 0.15),
    "elevator_nonlinearity": _elevator,
    "nonlinear_pitching_moment": _moment,
    "thrust_moment": _one("arm_m", 0.04, 0.4, signed=True, by="length"),
    "cg_shift": _one("aft_m", 0.015, 0.08, signed=True, by="chord"),
    "alpha_dot": lambda scale, g: {"cm_alpha_dot": -_log(g, 2.5, 14.0)},
    "nonlinear_lift": _lift,
    "unsteady_lift": _pair(_one("share", 0.12, 0.6), _one("lag_s", 0.06, 0.4)),
    "mass_change": _one("share", 0.06, 0.3, signed=True),
    "icing": _one("severity", 0.1, 0.6),
    "airspeed_variation": _pair(_one("share", 0.4, 1.0), _one("period_s", 15.0, 30.0)),
    "ground_effect": _pair(_one("lift", 0.1, 0.6), _one("moment", 0.004, 0.03, signed=True)),
    "turbulence": _pair(_one("sigma_w_m_s", 0.25, 1.2, by="speed"), _one("length_m", 30.0, 150.0)),
    "gust": _pair(_one("amplitude_m_s", 0.6, 3.0, by="speed"), _one("length_m", 12.0, 35.0, by="speed")),
    "alpha_lag": _one("lag_s", 0.012, 0.1),
    "alpha_scale": _one("scale", 0.03, 0.3, signed=True),
    "alpha_bias": _one("bias_rad", 0.008, 0.05, signed=True),
    "alpha_vane_offset": _one("arm_m", 0.15, 1.5, signed=True, by="length"),
    "pitch_rate_bias": _one("bias_rad_s", 0.003, 0.03, signed=True),
    "pitch_rate_scale": _one("scale", 0.03, 0.3, signed=True),
    "structural_mode": _mode,
    "accelerometer_offset": _one("arm_m", 0.04, 0.4, signed=True, by="length"),
    "alpha_skew": _SKEW,
    "pitch_rate_skew": _SKEW,
    "accelerometer_skew": _SKEW,
    "attitude_skew": _SKEW,
}
"""Range of the sizes of each effect of the gap diagnosis, by name."""

OUTSIDE: dict[str, Draw] = {
    "servo_hunting": _pair(_one("amplitude_rad", 0.1, 0.4, by="amplitude"), _one("frequency_hz", 0.8, 3.0)),
    "servo_stiction": _one("breakaway_rad", 0.2, 0.6, by="amplitude"),
    "wind_shear": _one("gradient_1_s", 0.1, 0.4),
    "sticky_vane": _one("hold_rad", 0.15, 0.6, by="swing"),
    "alpha_spikes": _pair(_one("height_rad", 0.3, 1.2, by="swing"), _one("each_s", 0.5, 2.0)),
    "vane_ageing": _one("growth", 4e-4, 3e-3),
    "vane_stop": _one("above_trim_rad", 0.2, 0.7, by="swing"),
    "gyro_saturation": _one("limit_rad_s", 0.05, 0.25),
    "gyro_quantisation": _one("step_rad_s", 0.02, 0.1),
    "gyro_g_sensitivity": _one("per_m2_s4", 6e-4, 4e-3),
    "accelerometer_saturation": _one("above_1g_m_s2", 0.7, 3.5),
    "accelerometer_rectification": _one("per_m_s2", 0.008, 0.06),
    "fuel_slosh": _pair(
        _one("cm", 0.05, 0.3), _pair(_one("frequency_hz", 0.6, 2.5), _one("damping", 0.01, 0.06))
    ),
    "asymmetric_damping": _one("cm_per_rad_s", 0.015, 0.08),
    "stall_hysteresis": _pair(_one("cl_loss", 0.02, 0.1), _one("band_rad", 0.3, 0.8, by="swing")),
    "propeller_buzz": _pair(_one("cm", 0.0015, 0.008), _one("frequency_hz", 0.7, 3.0)),
    "slipstream_beat": _pair(_one("share", 0.15, 0.6), _one("frequency_hz", 0.3, 1.5)),
}
"""Range of the sizes of each effect without a name in the gap diagnosis."""

ON_ANY_ENGINE = (
    "actuator_lag",
    "actuator_rate_limit",
    "actuator_backlash",
    "actuator_deadband",
    "transport_delay",
    "turbulence",
    "gust",
    "alpha_lag",
    "alpha_scale",
    "alpha_vane_offset",
    "pitch_rate_scale",
    "structural_mode",
    "accelerometer_offset",
    "alpha_skew",
    "pitch_rate_skew",
    "accelerometer_skew",
    "attitude_skew",
)
"""Effects outside the airframe, which JSBSim aircraft can also have."""
