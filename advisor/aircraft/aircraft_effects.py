"""Names and parameters of the effects that an aircraft file may add to the simulator's model."""

from collections.abc import Iterator, Mapping

_ANY = float("-inf")
_ONSET = {"rate_per_s": _ANY, "step": _ANY, "at_s": _ANY, "over_s": 0.0}

LEAST: Mapping[str, Mapping[str, float]] = {
    "actuator_lag": {"lag_s": 0.0, "damping": 0.0},
    "actuator_rate_limit": {"rate_rad_s": 0.0},
    "actuator_backlash": {"half_width_rad": 0.0},
    "actuator_deadband": {"half_width_rad": 0.0, "neutral_rad": _ANY, "about_trim": 0.0},
    "transport_delay": {"delay_s": 0.0},
    "elevator_nonlinearity": {"M_delta2": _ANY, "M_delta3": _ANY, "about_rad": _ANY},
    "nonlinear_pitching_moment": {"M_alpha2": _ANY, "M_alpha3": _ANY, "about_rad": _ANY},
    "thrust_moment": {
        "M_throttle": _ANY,
        "lag_s": 0.0,
        "M_thrust": _ANY,
        "washed_share": _ANY,
        "blown_share": _ANY,
    },
    "cg_shift": {**_ONSET, "stability_only": 0.0},
    "alpha_dot": {"M_alpha_dot": _ANY},
    "nonlinear_lift": {
        "Z_alpha2": _ANY,
        "Z_alpha3": _ANY,
        "about_rad": _ANY,
        "stall_rad": _ANY,
        "sharpness": 0.0,
    },
    "unsteady_lift": {"share": _ANY, "lag_s": 0.0, "with_moment": 0.0},
    "mass_change": {**_ONSET, "inertia": _ANY},
    "icing": {
        "Z_alpha": _ANY,
        "Z_delta_e": _ANY,
        "M_alpha": _ANY,
        "M_delta_e": _ANY,
        "at_s": _ANY,
        "over_s": 0.0,
    },
    "airspeed_variation": {"change": _ANY, "exponent": _ANY, "exponent_M": _ANY},
    "ground_effect": {"Z_h": _ANY, "lift_h": _ANY, "M_h": _ANY, "scale_m": 0.0},
    "turbulence": {"sigma_w_m_s": 0.0, "length_m": 0.0},
    "gust": {"amplitude_m_s": _ANY, "length_m": 0.0, "at_s": _ANY},
    # A channel may be ahead of the others where the others are filtered more slowly.
    "alpha_lag": {"lag_s": _ANY},
    "alpha_scale": {"scale": _ANY},
    "alpha_bias": {"bias_rad": _ANY},
    "alpha_vane_offset": {"arm_m": _ANY},
    "pitch_rate_bias": {"bias_rad_s": _ANY},
    "pitch_rate_scale": {"scale": _ANY},
    "structural_mode": {
        "frequency_hz": 0.0,
        "damping": 0.0,
        "gain": _ANY,
        "displacement_gain": _ANY,
        "with_attitude": 0.0,
    },
    "accelerometer_offset": {"arm_m": _ANY},
    "alpha_skew": {"skew_s": _ANY},
    "pitch_rate_skew": {"skew_s": _ANY},
    "accelerometer_skew": {"skew_s": _ANY},
    "attitude_skew": {"skew_s": _ANY, "with_pitch_rate": 0.0},
}
"""Effect name to its parameters, each with its least allowed value."""


def mistakes_in(effects: Mapping[str, Mapping[str, float]]) -> Iterator[str]:
    """Yield every mistake in an aircraft file's ``effects``, as ``path: description``."""
    for effect, sizes in effects.items():
        if effect not in LEAST:
            yield f"effects.{effect}: unknown effect, the effects are {' '.join(LEAST)}"
            continue
        for name, value in sizes.items():
            if name not in LEAST[effect]:
                known = " ".join(LEAST[effect])
                yield f"effects.{effect}.{name}: unknown key, the parameters are {known}"
            elif value < LEAST[effect][name]:
                yield f"effects.{effect}.{name}: must not be below {LEAST[effect][name]:g}, is {value:g}"
