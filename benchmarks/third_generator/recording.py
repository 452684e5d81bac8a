"""Samples of the shown channels as an autopilot sends them: uneven, rounded, noisy."""

import numpy as np
from numpy.random import Generator

from benchmarks.sealed.tlog import Stream

from .fleet import Floats
from .flight import STEP_S, Channels
from .instruments import Instruments, slow_noise

CARRIES = {
    "alpha": ("alpha",),
    "attitude": ("q", "theta"),
    "imu": ("a_x", "a_z", "imu_q"),
    "servo": ("command", "throttle"),
    "hud": ("airspeed", "climb", "height", "throttle"),
    "position": ("groundspeed", "climb", "height"),
}
ATTITUDE_ERROR_S = 1.0
MILLISECOND = 1e-3


def record(shown: Channels, kit: Instruments, rng: Generator) -> dict[str, Stream]:
    """Every stream of a flight."""
    count = shown["q"].size
    time = STEP_S * np.arange(count)
    seen = dict(shown)
    # The attitude filter's own slow error is in all that is made from the attitude.
    error = 0.3 * kit.noise["theta"] * slow_noise(count, STEP_S, ATTITUDE_ERROR_S, rng)
    seen["theta"] = seen["theta"] + error
    if not kit.boom:
        seen["alpha"] = seen["alpha"] + error
    seen["imu_q"] = seen["imu_q"] + kit.gyro_bias
    for name, share in kit.colour.items():
        seen[name] = seen[name] + np.sqrt(share) * kit.noise[name] * slow_noise(
            count, STEP_S, kit.colour_s, rng
        )
    sent = [name for name in CARRIES if name != "alpha" or kit.sends_alpha]
    streams = {name: _stream(name, CARRIES[name], time, seen, kit, rng) for name in sent}
    servo, hud = streams["servo"].channels, streams["hud"].channels
    servo["throttle_us"] = 1100.0 + 500.0 * servo["throttle"]
    hud["throttle_percent"] = 62.5 * hud["throttle"]
    return streams


def _stream(
    name: str, channels: tuple[str, ...], time: Floats, seen: Channels, kit: Instruments, rng: Generator
) -> Stream:
    period = 1.0 / kit.rates_hz[name]
    taken = np.arange(0.05 + period * float(rng.random()), time[-1] - 0.05, period)
    taken = taken + period * kit.uneven * rng.uniform(-0.5, 0.5, taken.size)
    stamps = taken + kit.stamp_error_s * rng.uniform(-1.0, 1.0, taken.size)
    stamps = np.maximum.accumulate(MILLISECOND * np.round(stamps / MILLISECOND))
    if name == "alpha" and not kit.boom:
        return Stream(stamps, {"alpha": _renewed(taken, time, seen["alpha"], kit, rng)})
    values = {}
    for channel in channels:
        white = np.sqrt(1.0 - kit.colour.get(channel, 0.0)) * kit.noise.get(channel, 0.0)
        values[channel] = np.interp(taken, time, seen[channel]) + white * rng.normal(size=taken.size)
    return Stream(stamps, values)


def _renewed(taken: Floats, time: Floats, alpha: Floats, kit: Instruments, rng: Generator) -> Floats:
    """A value that is computed less often than it is sent."""
    when = np.floor(taken * kit.alpha_renewed_hz) / kit.alpha_renewed_hz
    numbers = np.round(when * kit.alpha_renewed_hz).astype(int)
    white = np.sqrt(1.0 - kit.colour["alpha"]) * kit.noise["alpha"]
    error = white * rng.normal(size=int(numbers[-1]) + 1)
    return np.interp(when, time, alpha) + error[numbers]
