"""The table of effects: the prior knowledge of each effect, independent of its description in a fit.

Parameters, bounds, steps and least sizes are in the variants of each block. Keys of the aircraft file are in
``advisor.aircraft.aircraft_effects``.
"""

from advisor.gap.candidates.trait import Need, Trait

_NO_ALPHA = ("no angle of attack", "AOA_SSA at 50 Hz, or a vane")
_NO_A_Z = ("no vertical acceleration", "RAW_IMU at 50 Hz")
_NO_THETA = ("no attitude", "ATTITUDE at 50 Hz")
_FEW = ("fewer than three manoeuvres", "repeat the same manoeuvre early and late")
_ARMS = "measure where the vane and the IMU sit: alpha.vane_arm_m, accelerometer.arm_m"
_SURFACE = "log the measured surface position"
_AMPLITUDES = "fly two amplitudes: a rate limit delays larger steps more"
_SPEEDS = "fly at two air speeds: the arm's part goes with 1/V, the other does not"
_WEIGHT = "log fuel and weight; ice moves lift and control by different shares"
_TRIM = "see which elevator trims level flight at several speeds: there the angle of attack is steady"
_REPEAT = "repeat the same manoeuvre at the same air speed, early and late"
_UNFILTERED = (
    "a filter of that channel that delays as much",
    "log the channel as its sensor reads it, before any filter",
)

# fmt: off
TRAITS = {
    "actuator_lag": Trait(
        "input",
        said=(
            "The simulator's elevator is too quick: the real servo lags by {lag_s_ms:.0f} ms",
            "The simulator's elevator is too slow: its servo lags by {lag_s_ms:.0f} ms too much",
        ),
        said_beyond="The simulator's elevator is too quick: the real servo lags by {lag_s_ms:.0f} ms more",
        distinguished_by={"transport_delay": _SURFACE, "actuator_rate_limit": _AMPLITUDES},
        stated=("elevator", "lag_s"),
    ),
    "actuator_rate_limit": Trait(
        "input",
        said=(
            "The real elevator moves no faster than {rate_rad_s_deg:.0f} deg/s",
            "The simulator's elevator moves no faster than {rate_rad_s_deg:.0f} deg/s, and the real one does",
        ),
        distinguished_by={"transport_delay": _AMPLITUDES},
    ),
    "actuator_backlash": Trait(
        "input",
        said=(
            "The real elevator has play of {half_width_rad_deg:.2f} deg to either side",
            "The simulator's elevator has {half_width_rad_deg:.2f} deg too much play to either side",
        ),
        distinguished_by={"actuator_deadband": "fly two amplitudes, and steps short of neutral"},
    ),
    "actuator_deadband": Trait(
        "input",
        said=(
            "The real elevator ignores the first {half_width_rad_deg:.2f} deg around neutral",
            "The simulator's elevator ignores {half_width_rad_deg:.2f} deg too much around neutral",
        ),
        said_with={
            "about_trim": "The real elevator ignores the first {half_width_rad_deg:.2f} deg around its trim",
        },
        imitated_by=("lower elevator effectiveness, at one amplitude", "fly two amplitudes"),
    ),
    "transport_delay": Trait(
        "input",
        said=(
            "The simulator responds {delay_s_ms:.0f} ms too early: a delay between command and surface",
            "The simulator responds {delay_s_ms:.0f} ms too late: its delay is too long",
        ),
        said_beyond="The simulator responds {delay_s_ms:.0f} ms too early: the delay between command and "
        "surface is longer than its own",
        imitated_by=("an equal delay of every logged stream", _SURFACE), stated=("elevator", "delay_s"),
    ),
    "elevator_nonlinearity": Trait(
        "moment_equation", by_nature=True,
        said="The real elevator's moment is not proportional to its deflection",
        said_beyond="The real elevator's moment bends with its deflection otherwise than the simulator's",
        distinguished_by={"nonlinear_pitching_moment": "fly slow and fast steps of equal size"},
    ),
    "nonlinear_pitching_moment": Trait(
        "moment_equation", by_nature=True,
        said="The real pitching moment is not linear in the angle of attack",
        said_beyond="The real pitching moment bends with the angle of attack otherwise than the simulator's",
    ),
    "thrust_moment": Trait(
        "moment_equation", by_nature=True, of_the_stick=False,
        said="Thrust pitches the real aircraft: its line misses the centre of gravity",
        said_with={"lag_s": "Thrust pitches the real aircraft, {lag_s_ms:.0f} ms behind the throttle"},
        need=Need("M_throttle", "the throttle did not move", "fly at two air speeds"),
        unrecorded=("throttle", "no throttle in the log", "VFR_HUD at 10 Hz"),
    ),
    "cg_shift": Trait(
        "moment_equation", of_one_flight=True,
        said="The centre of gravity moved during the flight", need=Need("step", *_FEW),
        distinguished_by={"mass_change": _WEIGHT, "icing": _WEIGHT, "airspeed_variation": _REPEAT},
    ),
    "alpha_dot": Trait(
        "moment_equation", by_nature=True, of_the_stick=False,
        said="The rate of the angle of attack makes a pitching moment that the simulator lacks",
        need=Need("M_alpha_dot", "the derivatives mimic it", "pulses of a flap, which move α and not q"),
        imitated_by=("other derivatives of the pitching moment", _TRIM),
        distinguished_by={"unsteady_lift": "log the accelerometer at a higher rate"},
    ),
    "nonlinear_lift": Trait(
        "force_equation", by_nature=True,
        said="The real lift is not linear in the angle of attack",
        said_beyond="The real lift bends with the angle of attack otherwise than the simulator's",
    ),
    "unsteady_lift": Trait(
        "force_equation", by_nature=True, said="The real lift builds up with a lag of {lag_s_ms:.0f} ms",
    ),
    "mass_change": Trait(
        "force_equation", of_one_flight=True,
        said="The mass changed during the flight", need=Need("step", *_FEW),
        distinguished_by={"icing": _WEIGHT, "airspeed_variation": _REPEAT}, twin="icing",
    ),
    "icing": Trait(
        "force_equation", of_one_flight=True, by_nature=True,
        said="Lift and control weakened during the flight, as ice does", need=Need("Z_alpha", *_FEW),
        distinguished_by={"airspeed_variation": _REPEAT}, takes=True,
    ),
    "airspeed_variation": Trait(
        "force_equation", by_nature=True, of_the_stick=False,
        said="The air speed moved by up to {change_percent:.0f} % and the derivatives with it",
        said_with={
            "exponent": "The real forces do not grow with air speed squared, "
            "but with its power {exponent_power:.1f}",
            "exponent_M": "The real moments grow with the air speed's power {exponent_M_power:.1f}, "
            "the lift with {exponent_power:.1f}",
        },
        need=Need("change", "the air speed was constant", "fly at two air speeds"),
        unrecorded=("airspeed", "no air speed in the log", "VFR_HUD at 10 Hz"),
    ),
    "ground_effect": Trait(
        "force_equation", by_nature=True, of_the_stick=False, said="The ground was near enough to be felt",
        need=Need("Z_h", "the height hardly varied", "fly low and high with a range finder"),
        unrecorded=("height", "no height in the log", "fly low and high with a range finder"),
    ),
    "turbulence": Trait(
        "air", of_one_flight=True, said="The air was not still: gusts of about {sigma_w_m_s:.2g} m/s",
        need=Need("sigma_w_m_s", *_NO_ALPHA),
        distinguished_by={"gust": "fly more manoeuvres: a gust does not come back, turbulence does"},
    ),
    "gust": Trait(
        "air", of_one_flight=True,
        said=(
            "An upward gust of {amplitude_m_s:.2g} m/s passed",
            "A downward gust of {amplitude_m_s:.2g} m/s passed",
        ),
        need=Need("amplitude_m_s", *_NO_ALPHA),
    ),
    "alpha_lag": Trait(
        "alpha_sensor", channel="alpha", of_one_imu=True,
        said=(
            "The angle of attack channel lags by {lag_s_ms:.0f} ms",
            "The angle of attack channel is {lag_s_ms:.0f} ms ahead",
        ),
        need=Need("lag_s", *_NO_ALPHA),
        distinguished_by={
            "alpha_skew": "fly faster steps, or compare the channel's stamps with the vane's",
            "alpha_vane_offset": _SPEEDS,
        },
        twin="alpha_skew",
    ),
    "alpha_scale": Trait(
        "alpha_sensor", channel="alpha",
        said=(
            "The angle of attack channel reads {scale_percent:.0f} % too much",
            "The angle of attack channel reads {scale_percent:.0f} % too little",
        ),
        need=Need("scale", *_NO_ALPHA),
        imitated_without=("a_z", "Z_q of the model", "log the accelerometer (RAW_IMU) at 50 Hz"),
    ),
    "alpha_bias": Trait(
        "alpha_sensor", channel="alpha",
        said=(
            "The angle of attack channel reads {bias_rad_deg:.2f} deg too high",
            "The angle of attack channel reads {bias_rad_deg:.2f} deg too low",
        ),
        need=Need("bias_rad", "no climb rate", "VFR_HUD and ATTITUDE at 10 Hz"),
    ),
    "alpha_vane_offset": Trait(
        "alpha_sensor", channel="alpha", of_one_imu=True,
        said=(
            "The vane sits {arm_m:.2f} m ahead of the centre of gravity",
            "The vane sits {arm_m:.2f} m behind the centre of gravity",
        ),
        said_beyond=(
            "The vane sits {arm_m:.2f} m further ahead than in the simulator",
            "The vane sits {arm_m:.2f} m further back than in the simulator",
        ),
        need=Need("arm_m", *_NO_ALPHA),
        distinguished_by={"accelerometer_offset": _ARMS, "alpha_skew": _SPEEDS},
        twin="accelerometer_offset", stated=("alpha", "vane_arm_m"),
    ),
    "pitch_rate_bias": Trait(
        "pitch_rate_sensor",
        said=(
            "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too high",
            "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too low",
        ),
    ),
    "pitch_rate_scale": Trait(
        "pitch_rate_sensor", of_one_imu=True,
        said=(
            "The pitch rate reads {scale_percent:.1f} % too much",
            "The pitch rate reads {scale_percent:.1f} % too little",
        ),
    ),
    "structural_mode": Trait(
        "pitch_rate_sensor", by_nature=True,
        said="The structure swings at {frequency_hz:.1f} Hz in the pitch rate",
    ),
    "accelerometer_offset": Trait(
        "accelerometer", channel="a_z", of_one_imu=True,
        said=(
            "The accelerometer sits {arm_m:.2f} m ahead of the centre of gravity",
            "The accelerometer sits {arm_m:.2f} m behind the centre of gravity",
        ),
        said_beyond=(
            "The accelerometer sits {arm_m:.2f} m further ahead than in the simulator",
            "The accelerometer sits {arm_m:.2f} m further back than in the simulator",
        ),
        need=Need("arm_m", *_NO_A_Z), stated=("accelerometer", "arm_m"), left_open=True,
    ),
    "alpha_skew": Trait(
        "timing", channel="alpha", of_one_imu=True,
        said=(
            "The angle of attack is stamped {skew_s_ms:.0f} ms too late",
            "The angle of attack is stamped {skew_s_ms:.0f} ms too early",
        ),
        need=Need("skew_s", *_NO_ALPHA),
    ),
    "pitch_rate_skew": Trait(
        "timing",
        said=(
            "The pitch rate is stamped {skew_s_ms:.0f} ms too late",
            "The pitch rate is stamped {skew_s_ms:.0f} ms too early",
        ),
        imitated_by=_UNFILTERED,
    ),
    "accelerometer_skew": Trait(
        "timing", channel="a_z",
        said=(
            "The accelerometer is stamped {skew_s_ms:.0f} ms too late",
            "The accelerometer is stamped {skew_s_ms:.0f} ms too early",
        ),
        need=Need("skew_s", *_NO_A_Z), imitated_by=_UNFILTERED,
    ),
    "attitude_skew": Trait(
        "timing", channel="theta",
        said=(
            "The attitude is stamped {skew_s_ms:.0f} ms too late",
            "The attitude is stamped {skew_s_ms:.0f} ms too early",
        ),
        said_with={
            "with_pitch_rate": (
                "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too late",
                "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too early",
            ),
        },
        need=Need("skew_s", *_NO_THETA), imitated_by=_UNFILTERED,
    ),
}
# fmt: on
"""Every effect of the catalogue, in its order."""

OF_ONE_FLIGHT = frozenset(name for name, trait in TRAITS.items() if trait.of_one_flight)
BY_NATURE = frozenset(name for name, trait in TRAITS.items() if trait.by_nature)
TAKES = frozenset(name for name, trait in TRAITS.items() if trait.takes)
LEFT_OPEN = frozenset(name for name, trait in TRAITS.items() if trait.left_open)
OF_ONE_IMU = tuple(name for name, trait in TRAITS.items() if trait.of_one_imu)
