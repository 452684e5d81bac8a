"""What the instruments make of the truth, before noise: one array a channel on the flight's time grid."""

from dataclasses import dataclass, field

import numpy as np
from scipy.signal import lfilter

from .flight import Truth
from .kernel import Floats, kernel
from .motion import GRAVITY


@dataclass(frozen=True)
class Vane:
    """The angle-of-attack vane, `arm` [m] ahead of the centre of gravity, of first or second order."""

    arm: float = 0.0
    scale: float = 0.0
    bias: float = 0.0
    lag: float = 0.0
    natural_frequency: float = 0.0
    damping: float = 0.7
    half_play: float = 0.0
    stiction: float = 0.0
    upwash_curvature: float = 0.0
    spikes_per_second: float = 0.0
    spike_size: float = 0.0


@dataclass(frozen=True)
class Gyro:
    """The pitch rate gyro [SI]; `fuselage_bending` is its share of the structural mode's rate or angle."""

    scale: float = 0.0
    bias: float = 0.0
    fuselage_bending: float = 0.0
    bending_by_rate: bool = False
    g_sensitivity: float = 0.0
    saturation: float = np.inf
    asymmetry: float = 0.0
    alias: float = 0.0
    alias_frequency: float = 1.0


@dataclass(frozen=True)
class Accelerometer:
    """The accelerometers [SI]: `arm` [m] ahead of the centre of gravity, with their ailments."""

    arm: float = 0.0
    scale: float = 0.0
    saturation: float = np.inf
    leakage: float = 0.0
    alias: float = 0.0
    alias_frequency: float = 1.0


@dataclass(frozen=True)
class Attitude:
    """The attitude filter: it leans towards apparent gravity, freezes, or oscillates slowly."""

    lean: float = 0.0
    lean_time: float = 1.0
    freezes: tuple[tuple[float, float], ...] = ()
    oscillation: float = 0.0
    oscillation_frequency: float = 1.0


@dataclass(frozen=True)
class Clock:
    """How late a stream's values are at their stamps: a constant [s], a slow wander, and a drift [s/s]."""

    late: float = 0.0
    wander: float = 0.0
    wander_period: float = 20.0
    drift: float = 0.0

    def lateness(self, time: Floats) -> Floats:
        """Lateness [s] at each time."""
        lateness: Floats = (
            self.late + self.wander * np.sin(2.0 * np.pi * time / self.wander_period) + self.drift * time
        )
        return lateness


@dataclass(frozen=True)
class Instruments:
    """All instruments of an aircraft and the clocks of their streams."""

    vane: Vane = field(default_factory=Vane)
    gyro: Gyro = field(default_factory=Gyro)
    accelerometer: Accelerometer = field(default_factory=Accelerometer)
    attitude: Attitude = field(default_factory=Attitude)
    clocks: dict[str, Clock] = field(default_factory=dict)

    def clock(self, stream: str) -> Clock:
        """The clock of the stream "alpha", "gyro", "accelerometer" or "attitude"; a true one by default."""
        return self.clocks.get(stream, Clock())


@kernel
def second_order(signal: Floats, omega: float, damping: float, step: float) -> Floats:
    """A second-order low-pass, semi-implicit steps, begun at rest on the first value."""
    out = np.empty_like(signal)
    position, rate = signal[0], 0.0
    for k in range(len(signal)):
        rate += step * (omega**2 * (signal[k] - position) - 2.0 * damping * omega * rate)
        position += step * rate
        out[k] = position
    return out


@kernel
def with_play(signal: Floats, half: float) -> Floats:
    """A pointer driven through play: it moves when pushed."""
    out = np.empty_like(signal)
    position = signal[0]
    for k in range(len(signal)):
        position = min(max(position, signal[k] - half), signal[k] + half)
        out[k] = position
    return out


@kernel
def with_stiction(signal: Floats, threshold: float) -> Floats:
    """A pointer that sticks until its error reaches the threshold, then jumps to the right value."""
    out = np.empty_like(signal)
    position = signal[0]
    for k in range(len(signal)):
        if abs(signal[k] - position) >= threshold:
            position = signal[k]
        out[k] = position
    return out


def first_order(signal: Floats, lag: float, step: float) -> Floats:
    """A first-order low-pass, begun at rest on the first value."""
    decay = np.exp(-step / lag)
    filtered: Floats = lfilter([1.0 - decay], [1.0, -decay], signal - signal[0])
    filtered += signal[0]
    return filtered


def vane_reading(truth: Truth, vane: Vane, step: float, rng: np.random.Generator) -> Floats:
    """Angle of attack [rad] as the vane shows it."""
    reading = truth.alpha - vane.arm * truth.q / truth.airspeed
    if vane.natural_frequency > 0.0:
        reading = second_order(reading, vane.natural_frequency, vane.damping, step)
    elif vane.lag > 0.0:
        reading = first_order(reading, vane.lag, step)
    off = reading - np.median(reading)
    reading = (1.0 + vane.scale) * reading + vane.bias + vane.upwash_curvature * off * np.abs(off)
    if vane.half_play > 0.0:
        reading = with_play(reading, vane.half_play)
    if vane.stiction > 0.0:
        reading = with_stiction(reading, vane.stiction)
    if vane.spikes_per_second > 0.0:
        reading = reading + spikes(len(reading), vane, step, rng)
    return reading


def spikes(count: int, vane: Vane, step: float, rng: np.random.Generator) -> Floats:
    """Short excursions [rad] of an electrically noisy potentiometer."""
    out = np.zeros(count)
    for start in np.flatnonzero(rng.random(count) < vane.spikes_per_second * step):
        out[start : start + max(round(0.03 / step), 1)] += rng.choice([-1.0, 1.0]) * vane.spike_size
    return out


def gyro_reading(truth: Truth, gyro: Gyro, time: Floats) -> Floats:
    """Pitch rate [rad/s] as the gyro shows it."""
    bending = truth.mode_rate if gyro.bending_by_rate else truth.mode
    reading = (1.0 + gyro.scale) * truth.q + gyro.fuselage_bending * bending + gyro.bias
    reading = reading + gyro.asymmetry * np.abs(truth.q)
    reading = reading + gyro.g_sensitivity * (-truth.a_z / GRAVITY - 1.0)
    reading = reading + gyro.alias * np.sin(2.0 * np.pi * gyro.alias_frequency * time)
    limited: Floats = np.clip(reading, -gyro.saturation, gyro.saturation)
    return limited


def accelerometer_reading(truth: Truth, sensor: Accelerometer, time: Floats) -> tuple[Floats, Floats]:
    """Specific force [m/s^2] along x and z at the accelerometers' place, by rigid-body kinematics."""
    x = truth.a_x - sensor.arm * truth.q**2
    z = truth.a_z - sensor.arm * truth.q_dot
    z = (1.0 + sensor.scale) * z + sensor.alias * np.sin(2.0 * np.pi * sensor.alias_frequency * time)
    x = x + sensor.leakage * z
    # One g of the measuring range is used up in level flight.
    return x, np.clip(z, -GRAVITY - sensor.saturation, GRAVITY + sensor.saturation)


def attitude_reading(truth: Truth, sensor: Attitude, time: Floats, step: float) -> Floats:
    """Pitch angle [rad] as the attitude filter shows it."""
    reading = truth.theta.copy()
    if sensor.lean != 0.0:
        apparent = np.arctan2(truth.a_x, -truth.a_z) - truth.theta
        reading = reading + sensor.lean * first_order(apparent, sensor.lean_time, step)
    reading = reading + sensor.oscillation * np.sin(2.0 * np.pi * sensor.oscillation_frequency * time)
    for start, duration in sensor.freezes:
        first, last = round(start / step), round((start + duration) / step)
        reading[first:last] = reading[min(first, len(reading) - 1)]
    return reading


def observe(
    truth: Truth, instruments: Instruments, step: float, rng: np.random.Generator
) -> dict[str, Floats]:
    """Every channel as it will be stamped, without noise, on the time grid."""
    time = step * np.arange(len(truth.q))

    def stamped(channel: Floats, clock: Clock) -> Floats:
        values: Floats = np.interp(time - clock.lateness(time), time, channel)
        return values

    a_x, a_z = accelerometer_reading(truth, instruments.accelerometer, time)
    return {
        "alpha": stamped(vane_reading(truth, instruments.vane, step, rng), instruments.clock("alpha")),
        "q": stamped(gyro_reading(truth, instruments.gyro, time), instruments.clock("gyro")),
        "theta": stamped(
            attitude_reading(truth, instruments.attitude, time, step), instruments.clock("attitude")
        ),
        "a_x": stamped(a_x, instruments.clock("accelerometer")),
        "a_z": stamped(a_z, instruments.clock("accelerometer")),
        "airspeed": truth.airspeed,
        "climb": truth.climb,
        "height": truth.height,
    }
