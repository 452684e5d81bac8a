"""What it takes to see an effect: channels, and a flight in which its cause varies."""

from collections.abc import Sequence
from dataclasses import dataclass


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
    "thrust_moment": Need("M_throttle", "the throttle did not move", "two air speeds; VFR_HUD at 10 Hz"),
    "ground_effect": Need("Z_h", "height above ground not varied", "fly low and high with a range finder"),
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
    "airspeed_variation": Need("change", "air speed not logged or constant", "two speeds; VFR_HUD at 10 Hz"),
    "cg_shift": Need("step", *_FEW),
    "mass_change": Need("step", *_FEW),
    "icing": Need("Z_alpha", *_FEW),
}
OTHERWISE = "fly another time unit and another amplitude"
"""When nothing particular is known that would tell two effects apart."""
_CHANNELS = {"alpha": "AOA_SSA at 50 Hz", "a_z": "RAW_IMU at 50 Hz", "theta": "ATTITUDE at 50 Hz"}


_NOT_OF_THE_STICK = frozenset({"ground_effect", "thrust_moment", "airspeed_variation", "alpha_dot"})
"""Effects that the elevator alone cannot show: something else must vary."""


def hidden_from(effect: str, channels: Sequence[str]) -> tuple[str, str]:
    """Why an effect that was looked for leaves no mark of its own, and what to add."""
    if effect in _NOT_OF_THE_STICK:
        return NEEDS[effect].because, NEEDS[effect].add
    missing = [message for channel, message in _CHANNELS.items() if channel not in channels]
    if missing:
        return "these channels do not show it", " and ".join(missing)
    return "these manoeuvres do not show it", f"fly larger steps; {OTHERWISE}"
