"""What it takes to see an effect: channels, and a flight in which its cause varies."""

from dataclasses import dataclass, replace

from advisor.gap.records.flights import Flights


@dataclass(frozen=True, slots=True)
class Need:
    """Why an effect cannot be seen, and what would change that."""

    parameter: str
    """Its size, as the aircraft file spells it."""
    because: str
    add: str


_NO_ALPHA = ("no angle of attack", "AOA_SSA at 50 Hz, or a vane")
_NO_A_Z = ("no vertical acceleration", "RAW_IMU at 50 Hz")
_NO_THETA = ("no attitude", "ATTITUDE at 50 Hz")
_FEW = ("fewer than three manoeuvres", "repeat the same manoeuvre early and late")
NEEDS = {
    "thrust_moment": Need("M_throttle", "the throttle did not move", "fly at two air speeds"),
    "ground_effect": Need("Z_h", "the height hardly varied", "fly low and high with a range finder"),
    "alpha_dot": Need("M_alpha_dot", "the derivatives mimic it", "pulses of a flap, which move α and not q"),
    "alpha_bias": Need("bias_rad", "no climb rate", "VFR_HUD and ATTITUDE at 10 Hz"),
    "alpha_lag": Need("lag_s", *_NO_ALPHA),
    "alpha_vane_offset": Need("arm_m", *_NO_ALPHA),
    "alpha_skew": Need("skew_s", *_NO_ALPHA),
    "alpha_scale": Need("scale", *_NO_ALPHA),
    "turbulence": Need("sigma_w_m_s", *_NO_ALPHA),
    "gust": Need("amplitude_m_s", *_NO_ALPHA),
    "accelerometer_offset": Need("arm_m", *_NO_A_Z),
    "accelerometer_skew": Need("skew_s", *_NO_A_Z),
    "attitude_skew": Need("skew_s", *_NO_THETA),
    "airspeed_variation": Need("change", "the air speed was constant", "fly at two air speeds"),
    "cg_shift": Need("step", *_FEW),
    "mass_change": Need("step", *_FEW),
    "icing": Need("Z_alpha", *_FEW),
}
_ABSENT = {
    "thrust_moment": ("throttle", "no throttle in the log", "VFR_HUD at 10 Hz"),
    "ground_effect": ("height", "no height in the log", "fly low and high with a range finder"),
    "airspeed_variation": ("airspeed", "no air speed in the log", "VFR_HUD at 10 Hz"),
}
"""Slow channel that tells of an effect, and what to say instead where it was not recorded at all."""
OTHERWISE = "fly another time unit and another amplitude"
"""When nothing particular is known that would tell two effects apart."""
_CHANNELS = {"alpha": "AOA_SSA at 50 Hz", "a_z": "RAW_IMU at 50 Hz", "theta": "ATTITUDE at 50 Hz"}


_NOT_OF_THE_STICK = frozenset({"ground_effect", "thrust_moment", "airspeed_variation", "alpha_dot"})
"""Effects that the elevator alone cannot show: something else must vary."""

OF_ONE_IMU = ("alpha_lag", "alpha_skew", "alpha_vane_offset", "pitch_rate_scale", "accelerometer_offset")
"""What an angle of attack cannot show that an autopilot makes of its own pitch rate and accelerations: these
go with it, and its lateness is its nature."""
ONE_IMU = ("the angle of attack is made of the same inertial sensors", "a vane")
"""Why, and what would show it."""


def need_of(effect: str, flights: Flights) -> Need:
    """Why these flights cannot show an effect: its channel was not recorded, or did not vary."""
    need = NEEDS[effect]
    if effect in _ABSENT:
        channel, because, add = _ABSENT[effect]
        if channel not in flights.has:
            return replace(need, because=because, add=add)
    if effect == "airspeed_variation" and not flights.speed_measured:
        return replace(need, because="the air speed reads next to nothing", add="check the air speed sensor")
    return need


def hidden_from(effect: str, flights: Flights) -> tuple[str, str]:
    """Why an effect that was looked for leaves no mark of its own, and what to add."""
    if effect in _NOT_OF_THE_STICK:
        need = need_of(effect, flights)
        return need.because, need.add
    missing = [message for channel, message in _CHANNELS.items() if channel not in flights.channels]
    if missing:
        return "these channels do not show it", " and ".join(missing)
    return "these manoeuvres do not show it", f"fly larger steps; {OTHERWISE}"
