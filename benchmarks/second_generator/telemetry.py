"""What the logger writes down: stamps of each stream, noise, a low-pass; messages bring the quantisation."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import butter, lfilter, sosfiltfilt

from benchmarks.sealed.tlog import Stream

from .flight import Truth
from .kernel import Floats

# Which channels travel together: one stamp for all of them.
STREAMS = {
    "alpha": ("alpha",),
    "attitude": ("q", "theta"),
    "imu": ("a_x", "a_z", "imu_q"),
    "servo": ("command", "thrust"),
    "hud": ("airspeed", "climb", "height"),
    "position": ("climb", "height", "groundspeed"),
}


@dataclass(frozen=True)
class Noise:
    """Standard deviation of each channel's noise [SI]; `colour` is the slow share, with `memory` [s]."""

    alpha: float
    q: float
    theta: float
    a_x: float
    a_z: float
    airspeed: float
    climb: float
    height: float
    colour: float = 0.0
    memory: float = 0.1

    def of(self, channel: str) -> float:
        """Standard deviation of one channel; the command and the throttle are known exactly."""
        names = {"imu_q": "q", "command": "", "thrust": "", "groundspeed": "airspeed"}
        name = names.get(channel, channel)
        return float(getattr(self, name)) if name else 0.0


def quieter(noise: Noise, factor: float) -> Noise:
    """Return the noise with all standard deviations times a factor."""
    channels = ("alpha", "q", "theta", "a_x", "a_z", "airspeed", "climb", "height")
    return replace(noise, **{name: factor * getattr(noise, name) for name in channels})


@dataclass(frozen=True)
class Recorder:
    """Rates [Hz] of the streams, jitter of their stamps [s], low-pass [Hz] of a record filtered afterwards.

    `servo_in_step` says that the servo's message is written when the command is renewed.
    """

    rates: dict[str, float] = field(default_factory=dict)
    jitter: float = 0.0
    low_pass: float | None = None
    servo_in_step: bool = True


def noise_series(count: int, period: float, std: float, noise: Noise, rng: np.random.Generator) -> Floats:
    """Noise of one channel [SI]: white, or partly a first-order Markov process."""
    white, slow = rng.standard_normal((2, count))
    decay = np.exp(-period / noise.memory)
    slow = lfilter([np.sqrt(1.0 - decay**2)], [1.0, -decay], slow)
    series: Floats = std * (np.sqrt(1.0 - noise.colour) * white + np.sqrt(noise.colour) * slow)
    return series


def _instants(rate: float, duration: float, in_step: bool, rng: np.random.Generator) -> Floats:
    phase = 0.0 if in_step else rng.uniform(0.0, 1.0) / rate
    return np.arange(phase, duration - 0.05, 1.0 / rate)


def _at(time: Floats, series: Floats, instants: Floats, held: bool) -> Floats:
    if held:
        # A digital command is the one last renewed, not something between two.
        return series[np.searchsorted(time, instants + 1e-9, side="right") - 1]
    return np.interp(instants, time, series)


def _filtered(series: Floats, rate: float, low_pass: float) -> Floats:
    smooth: Floats = sosfiltfilt(butter(4, low_pass, fs=rate, output="sos"), series)
    return smooth


def record(
    time: Floats,
    observed: dict[str, Floats],
    truth: Truth,
    recorder: Recorder,
    noise: Noise,
    rng: np.random.Generator,
) -> dict[str, Stream]:
    """Sample every stream; the noise is drawn the same way whatever the flight was."""
    series = dict(observed, imu_q=observed["q"], command=truth.command, thrust=truth.thrust)
    streams = {}
    for name, channels in STREAMS.items():
        rate = recorder.rates[name]
        in_step = name == "servo" and recorder.servo_in_step
        instants = _instants(rate, float(time[-1]), in_step, rng)
        jitter = rng.uniform(-1.0, 1.0, len(instants)) * min(recorder.jitter, 0.4 / rate)
        values = {}
        for channel in channels:
            if recorder.low_pass is None:
                values[channel] = _at(time, series[channel], instants, held=channel == "command")
                values[channel] = values[channel] + noise_series(
                    len(instants), 1.0 / rate, noise.of(channel), noise, rng
                )
            else:
                # The record was taken fast, filtered on the ground without phase, and stored slower.
                period = float(time[1] - time[0])
                fast = series[channel] + noise_series(len(time), period, 2.0 * noise.of(channel), noise, rng)
                values[channel] = np.interp(instants, time, _filtered(fast, 1.0 / period, recorder.low_pass))
        streams[name] = Stream(np.maximum(instants + jitter, 0.0), values)
    servo, hud = streams["servo"], streams["hud"]
    servo.channels["throttle_us"] = 1100.0 + 270.0 * servo.channels["thrust"]
    hud.channels["throttle_percent"] = 34.0 * np.interp(hud.stamps, servo.stamps, servo.channels["thrust"])
    return streams
