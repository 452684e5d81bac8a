"""What an effect is, in words a pilot knows, with its size."""

import math

from advisor.aircraft import Aircraft
from advisor.gap.result import Cause
from advisor.gap.search.merit import LEAST_SIGMA

_WHAT: dict[str, str | tuple[str, str]] = {
    "transport_delay": (
        "The simulator answers {delay_s_ms:.0f} ms too early: a delay between command and surface",
        "The simulator answers {delay_s_ms:.0f} ms too late: its delay is too long",
    ),
    "actuator_lag": (
        "The simulator's elevator is too quick: the real servo lags by {lag_s_ms:.0f} ms",
        "The simulator's elevator is too slow: its servo lags by {lag_s_ms:.0f} ms too much",
    ),
    "actuator_rate_limit": "The real elevator moves no faster than {rate_rad_s_deg:.0f} deg/s",
    "actuator_backlash": (
        "The real elevator has play of {half_width_rad_deg:.2f} deg to either side",
        "The simulator's elevator has {half_width_rad_deg:.2f} deg too much play to either side",
    ),
    "actuator_deadband": (
        "The real elevator ignores the first {half_width_rad_deg:.2f} deg around neutral",
        "The simulator's elevator ignores {half_width_rad_deg:.2f} deg too much around neutral",
    ),
    "actuator_deadband about_trim": "The real elevator ignores the first {half_width_rad_deg:.2f} deg around "
    "its trim",
    "elevator_nonlinearity": "The real elevator's moment is not proportional to its deflection",
    "nonlinear_pitching_moment": "The real pitching moment is not linear in the angle of attack",
    "thrust_moment": "Thrust pitches the real aircraft: its line misses the centre of gravity",
    "thrust_moment lag_s": "Thrust pitches the real aircraft, {lag_s_ms:.0f} ms behind the throttle",
    "cg_shift": "The centre of gravity moved during the flight",
    "alpha_dot": "The rate of the angle of attack makes a pitching moment that the simulator lacks",
    "nonlinear_lift": "The real lift is not linear in the angle of attack",
    "unsteady_lift": "The real lift builds up with a lag of {lag_s_ms:.0f} ms",
    "mass_change": "The mass changed during the flight",
    "icing": "Lift and control weakened during the flight, as ice does",
    "airspeed_variation": "The air speed moved by up to {change_percent:.0f} % and the derivatives with it",
    "airspeed_variation exponent": "The real forces do not grow with air speed squared, "
    "but with its power {exponent_power:.1f}",
    "airspeed_variation exponent_M": "The real moments grow with the air speed's power "
    "{exponent_M_power:.1f}, the lift with {exponent_power:.1f}",
    "ground_effect": "The ground was near enough to be felt",
    "turbulence": "The air was not still: gusts of about {sigma_w_m_s:.2g} m/s",
    "gust": (
        "An upward gust of {amplitude_m_s:.2g} m/s passed",
        "A downward gust of {amplitude_m_s:.2g} m/s passed",
    ),
    "alpha_lag": (
        "The angle of attack channel lags by {lag_s_ms:.0f} ms",
        "The angle of attack channel is {lag_s_ms:.0f} ms ahead",
    ),
    "alpha_scale": (
        "The angle of attack channel reads {scale_percent:.0f} % too much",
        "The angle of attack channel reads {scale_percent:.0f} % too little",
    ),
    "alpha_bias": (
        "The angle of attack channel reads {bias_rad_deg:.2f} deg too high",
        "The angle of attack channel reads {bias_rad_deg:.2f} deg too low",
    ),
    "alpha_vane_offset": (
        "The vane sits {arm_m:.2f} m ahead of the centre of gravity",
        "The vane sits {arm_m:.2f} m behind the centre of gravity",
    ),
    "pitch_rate_bias": (
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too high",
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too low",
    ),
    "pitch_rate_scale": (
        "The pitch rate reads {scale_percent:.1f} % too much",
        "The pitch rate reads {scale_percent:.1f} % too little",
    ),
    "structural_mode": "The structure swings at {frequency_hz:.1f} Hz in the pitch rate",
    "accelerometer_offset": (
        "The accelerometer sits {arm_m:.2f} m ahead of the centre of gravity",
        "The accelerometer sits {arm_m:.2f} m behind the centre of gravity",
    ),
    "alpha_skew": (
        "The angle of attack is stamped {skew_s_ms:.0f} ms too late",
        "The angle of attack is stamped {skew_s_ms:.0f} ms too early",
    ),
    "pitch_rate_skew": (
        "The pitch rate is stamped {skew_s_ms:.0f} ms too late",
        "The pitch rate is stamped {skew_s_ms:.0f} ms too early",
    ),
    "accelerometer_skew": (
        "The accelerometer is stamped {skew_s_ms:.0f} ms too late",
        "The accelerometer is stamped {skew_s_ms:.0f} ms too early",
    ),
    "attitude_skew": (
        "The attitude is stamped {skew_s_ms:.0f} ms too late",
        "The attitude is stamped {skew_s_ms:.0f} ms too early",
    ),
    "attitude_skew with_pitch_rate": (
        "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too late",
        "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too early",
    ),
}
"""Effect, and with a parameter that makes it a particular one: how it is put. Of two ways the second is for a
first number below zero; sizes are without their sign then."""
_BEYOND: dict[str, str | tuple[str, str]] = {
    "transport_delay": "The simulator answers {delay_s_ms:.0f} ms too early: the delay between command and "
    "surface is longer than its own",
    "actuator_lag": "The simulator's elevator is too quick: the real servo lags by {lag_s_ms:.0f} ms more",
    "alpha_vane_offset": (
        "The vane sits {arm_m:.2f} m further ahead than in the simulator",
        "The vane sits {arm_m:.2f} m further back than in the simulator",
    ),
    "accelerometer_offset": (
        "The accelerometer sits {arm_m:.2f} m further ahead than in the simulator",
        "The accelerometer sits {arm_m:.2f} m further back than in the simulator",
    ),
}
"""The same where the simulator has some of it already."""


def what(cause: Cause, in_simulator: frozenset[str] = frozenset()) -> str:
    """The effect as a statement with its size.

    ``in_simulator`` are effects that the aircraft file has some of: the size is what it lacks.
    """
    sizes = {}
    for name, value in cause.parameters.items():
        sizes[name] = value.value
        sizes[f"{name}_ms"] = 1e3 * value.value
        sizes[f"{name}_deg"] = math.degrees(value.value)
        sizes[f"{name}_percent"] = 100.0 * value.value
        sizes[f"{name}_power"] = 2.0 + value.value
    # A lag that may as well be none is not worth telling.
    telling = [
        f"{cause.effect} {name}"
        for name, value in cause.parameters.items()
        if name != "lag_s" or abs(value.value) > LEAST_SIGMA * value.std
    ]
    put = _WHAT[next((key for key in telling if key in _WHAT), cause.effect)]
    below = next(iter(sizes.values()), 0.0) < 0.0
    if cause.effect in in_simulator and cause.effect in _BEYOND:
        beyond = _BEYOND[cause.effect]
        put = beyond if isinstance(beyond, tuple) or not below else put
    if isinstance(put, str):
        return put.format(**sizes)
    return put[1 if below else 0].format(**{name: abs(size) for name, size in sizes.items()})


def in_simulator(aircraft: Aircraft) -> frozenset[str]:
    """Effects that the aircraft file has some of, in ``effects`` or as a number of its own."""
    stated = {
        "actuator_lag": aircraft.elevator.lag_s, "transport_delay": aircraft.elevator.delay_s,
        "alpha_vane_offset": aircraft.alpha.vane_arm_m, "accelerometer_offset": aircraft.accelerometer.arm_m,
    }  # fmt: skip
    return frozenset(aircraft.effects) | {effect for effect, size in stated.items() if size}
