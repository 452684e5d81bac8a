"""The diagnosis in a sentence, as a pilot hears it."""

import math
from collections.abc import Sequence

from advisor.gap.result import VISIBLE, Cause, Gap, Shrink, Verdict, Where, spelled
from advisor.gap.search.merit import LEAST_SIGMA

_WHAT = {
    "transport_delay": "The simulator answers {delay_s_ms:.0f} ms too early: "
    "a delay between command and surface",
    "actuator_lag": "The simulator's elevator is too quick: the real servo lags by {lag_s_ms:.0f} ms",
    "actuator_rate_limit": "The real elevator moves no faster than {rate_rad_s_deg:.0f} deg/s",
    "actuator_backlash": "The real elevator has play of {half_width_rad_deg:.2f} deg to either side",
    "actuator_deadband": "The real elevator ignores the first {half_width_rad_deg:.2f} deg around neutral",
    "actuator_deadband about_trim": "The real elevator ignores the first {half_width_rad_deg:.2f} deg around "
    "its trim",
    "elevator_nonlinearity": "The real elevator's moment is not proportional to its deflection",
    "nonlinear_pitching_moment": "The real pitching moment curves with angle of attack",
    "thrust_moment": "Thrust pitches the real aircraft",
    "thrust_moment lag_s": "Thrust pitches the real aircraft, {lag_s_ms:.0f} ms behind the throttle",
    "cg_shift": "The centre of gravity moved during the flight",
    "alpha_dot": "The rate of angle of attack makes another moment than in the simulator",
    "nonlinear_lift": "The real lift curves with angle of attack",
    "unsteady_lift": "The real lift builds up with a lag of {lag_s_ms:.0f} ms",
    "mass_change": "The mass changed during the flight",
    "icing": "Lift and control weakened during the flight, as ice does",
    "airspeed_variation": "The air speed moved by up to {change_percent:.0f} % and the derivatives with it",
    "airspeed_variation exponent": "The real forces do not grow with air speed squared, "
    "but with its power {exponent_power:.1f}",
    "airspeed_variation exponent_M": "The real moments grow with the air speed's power "
    "{exponent_M_power:.1f}, the lift with {exponent_power:.1f}",
    "ground_effect": "The ground was near enough to be felt",
    "turbulence": "The air was not still: gusts of {sigma_w_m_s:.2g} m/s",
    "gust": "A gust of {amplitude_m_s:.2g} m/s passed",
    "alpha_lag": "The angle of attack channel lags by {lag_s_ms:.0f} ms",
    "alpha_scale": "The angle of attack channel reads {scale_percent:+.0f} % off",
    "alpha_bias": "The angle of attack channel is {bias_rad_deg:+.2f} deg off",
    "alpha_vane_offset": "The vane sits {arm_m:.2f} m ahead of the centre of gravity",
    "pitch_rate_bias": "The pitch rate is {bias_rad_s_deg:+.2f} deg/s off",
    "pitch_rate_scale": "The pitch rate reads {scale_percent:+.1f} % off",
    "structural_mode": "The structure swings at {frequency_hz:.1f} Hz in the pitch rate",
    "accelerometer_offset": "The accelerometer sits {arm_m:.2f} m ahead of the centre of gravity",
    "alpha_skew": "The angle of attack's time stamps are {skew_s_ms:+.0f} ms off",
    "pitch_rate_skew": "The pitch rate's time stamps are {skew_s_ms:+.0f} ms off",
    "accelerometer_skew": "The accelerometer's time stamps are {skew_s_ms:+.0f} ms off",
    "attitude_skew": "The attitude's time stamps are {skew_s_ms:+.0f} ms off",
    "attitude_skew with_pitch_rate": "The time stamps of attitude and pitch rate are {skew_s_ms:+.0f} ms off",
}
_TOO_MUCH = {
    "transport_delay": (-1.0, "The simulator answers {delay_s_ms:.0f} ms too late: its delay is too long"),
    "actuator_lag": (
        -1.0,
        "The simulator's elevator is too slow: its servo lags by {lag_s_ms:.0f} ms too much",
    ),
    "actuator_backlash": (
        -1.0,
        "The simulator's elevator has {half_width_rad_deg:.2f} deg too much play to either side",
    ),
    "actuator_deadband": (
        -1.0,
        "The simulator's elevator ignores {half_width_rad_deg:.2f} deg too much around neutral",
    ),
}
"""What is said where the aircraft file has too much of an effect; the sign of its first number then."""
_AS_LIKELY = 0.99
"""Score beside the best from which on another block is as likely a place."""
_BLOCK = {
    "input": "between the command and the surface",
    "force_equation": "in the lift",
    "moment_equation": "in the pitching moment",
    "air": "in the air",
    "alpha_sensor": "in the angle of attack channel",
    "pitch_rate_sensor": "in the pitch rate channel",
    "accelerometer": "in the accelerometer",
    "attitude_sensor": "in the attitude channel",
    "timing": "in the time stamps",
}


def what(cause: Cause) -> str:
    """The effect as a statement with its size."""
    sizes = {}
    for name, value in cause.parameters.items():
        sizes[name] = value.value
        sizes[f"{name}_ms"] = 1e3 * value.value
        sizes[f"{name}_deg"] = math.degrees(value.value)
        sizes[f"{name}_percent"] = 100.0 * value.value
        sizes[f"{name}_power"] = 2.0 + value.value
    sign, less = _TOO_MUCH.get(cause.effect, (0.0, ""))
    if sign * next(iter(sizes.values()), 0.0) > 0.0:
        return less.format(**{name: abs(size) for name, size in sizes.items()})
    # A lag that may as well be none is not worth telling.
    telling = [
        f"{cause.effect} {name}"
        for name, value in cause.parameters.items()
        if name != "lag_s" or abs(value.value) > LEAST_SIGMA * value.std
    ]
    particular = next((key for key in telling if key in _WHAT), cause.effect)
    return _WHAT[particular].format(**sizes)


def place(block: str) -> str:
    """Where a block is, in words."""
    return _BLOCK[block]


def sentence_of(
    verdict: Verdict, gap: Gap, where: Where, causes: Sequence[Cause], shrink: Shrink | None
) -> str:
    """One sentence for the crew."""
    present = [c for c in causes if c.present]
    if verdict == "none":
        if gap.before < VISIBLE:
            left = "nothing is left above the noise"
        elif gap.after < 0.5 * gap.before:
            percent = 100.0 * (1.0 - gap.after / gap.before)
            left = f"its numbers are right to a few per cent; fitted ones remove {percent:.0f} % of the gap"
        else:
            left = "too little for a name is left above the noise"
        return f"The simulator flies like the aircraft: {left}."
    removed = f"{max(shrink.percent, 0.0):.0f} % of the gap" if shrink is not None else "the gap"
    if verdict == "parameters":
        if shrink is not None and shrink.beyond_air_percent is not None:
            removed = f"{shrink.beyond_air_percent:.0f} % of the gap, and the air makes the rest"
        of_the_numbers = f"wrong numbers: the fitted eight remove {removed}"
        if shrink is not None and shrink.by_numbers_percent is not None and present:
            besides = ", ".join(spelled(c.effect) for c in present)
            return f"The simulator has {of_the_numbers}; little is left to {besides}."
        return f"The simulator has the right structure and {of_the_numbers}."
    if verdict == "unknown":
        tried = next((c for c in causes if c.probability > 0.02), None)
        near = f"; nearest, but not enough: {spelled(tried.effect)}" if tried is not None else ""
        if present:
            near = f", beside what looks like {', '.join(spelled(c.effect) for c in present)}"
        alike = [place(b) for b, score in where.ranking if b != where.block and score >= _AS_LIKELY]
        places = " or ".join([place(where.block), *alike])
        return f"Something {places} that no known effect explains{near}."
    also = ""
    if len(present) > 1:
        also = "; also " + ", ".join(spelled(c.effect) for c in present[1:])
    if present[0].block == "air" and len(present) == 1:
        numbers = ""
        if shrink is not None and shrink.beyond_air_percent is not None:
            numbers = (
                f"; its numbers are off besides, which makes {shrink.beyond_air_percent:.0f} % of the gap"
            )
        return f"{what(present[0])}: that is the air, not the simulator{numbers}."
    if shrink is not None and shrink.beyond_air_percent is not None:
        removed = f"{shrink.beyond_air_percent:.0f} % of the gap that is not the air's"
    if present[0].effect == "alpha_lag" and shrink is not None and round(shrink.percent) <= 0:
        return f"{what(present[0])}: the motion itself shows it{also}."
    added = "adding it"
    if shrink is not None and shrink.by_numbers_percent is not None:
        # What the numbers do must not pass for the effect's work.
        added = "adding it and fitting the eight numbers anew"
        removed += f" (the numbers alone {shrink.by_numbers_percent:.0f} %)"
    return f"{what(present[0])}; {added} removes {removed}{also}."
