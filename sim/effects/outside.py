"""Effects without a name in the gap diagnosis, whose right verdict is unknown."""

import math

import numpy as np

from ..airframe import GRAVITY_M_S2
from ..motion import Motion
from ..sensors import Reading
from .actuator import Stiction
from .air import WindShear
from .instruments import Transformed
from .kit import Kind, Kit, Sizes


class _LimitCycle:
    """A servo that oscillates around its command."""

    def __init__(self, amplitude_rad: float, frequency_hz: float) -> None:
        self.amplitude, self.omega = amplitude_rad, 2 * math.pi * frequency_hz
        self._phase = 0.0

    def reset(self, value: float) -> None:
        self._phase = 0.0

    def step(self, value: float, dt: float) -> float:
        self._phase += self.omega * dt
        return value + self.amplitude * math.sin(self._phase)


class _StickyVane:
    """A vane with dry friction, which stays until the air has turned by more than a threshold."""

    def __init__(self, hold_rad: float) -> None:
        self.hold = hold_rad
        self._shown: float | None = None

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        if self._shown is None or abs(reading.alpha - self._shown) > self.hold:
            self._shown = reading.alpha
        reading.alpha = self._shown


class _Spikes:
    """An angle-of-attack channel with occasional jumps of a tenth of a second."""

    def __init__(self, height_rad: float, each_s: float, generator: np.random.Generator) -> None:
        self.height, self.each_s, self._generator = height_rad, each_s, generator
        self._left = 0.0
        self._sign = 1.0

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        self._left -= dt
        if self._left <= 0.0 and self._generator.random() < dt / self.each_s:
            self._left = 0.1
            self._sign = 1.0 if self._generator.random() < 0.5 else -1.0
        if self._left > 0.0:
            reading.alpha += self._sign * self.height


class _AgeingVane:
    """Angle of attack from an ageing or freezing vane, whose filter grows during the flight."""

    def __init__(self, growth: float) -> None:
        self.growth = growth
        self._time = 0.0
        self._shown: float | None = None

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        self._time += dt
        if self._shown is None:
            self._shown = reading.alpha
        lag = 1e-4 + self.growth * self._time
        self._shown = reading.alpha + (self._shown - reading.alpha) * math.exp(-dt / lag)
        reading.alpha = self._shown


class _Slosh:
    """Sloshing fuel that loads the nose: a lightly damped mass driven by pitching."""

    def __init__(self, moment: float, frequency_hz: float, damping: float) -> None:
        self.moment, self.omega, self.damping = moment, 2 * math.pi * frequency_hz, damping
        self._place = self._rate = 0.0

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        pull = motion.q_dot - self.omega**2 * self._place - 2 * self.damping * self.omega * self._rate
        self._rate += pull * dt
        self._place += self._rate * dt
        return 0.0, -self.moment * self._place


class _AsymmetricDamping:
    """Pitch damping that differs between nose up and nose down. A tail in the wing's wake causes such
    damping.
    """

    def __init__(self, moment: float) -> None:
        self.moment = moment

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        return 0.0, -self.moment * abs(motion.q)


class _StallHysteresis:
    """Flow that separates late and attaches late, so that lift is missing only while the angle of attack
    falls.
    """

    def __init__(self, loss: float, band_rad: float) -> None:
        self.loss, self.band = loss, band_rad
        self._trim: float | None = None
        self._separated = 0.0

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        if self._trim is None:
            self._trim = motion.alpha
        off = motion.air_alpha - self._trim
        target = self._separated
        if off > self.band:
            target = 1.0
        elif off < 0.0:
            target = 0.0
        self._separated += (target - self._separated) * min(1.0, dt / 0.03)
        return -self.loss * self._separated, 0.0


class _Buzz:
    """A moment that oscillates independently of the flight."""

    def __init__(self, moment: float, frequency_hz: float) -> None:
        self.moment, self.omega = moment, 2 * math.pi * frequency_hz

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        return 0.0, self.moment * math.sin(self.omega * time_s)


class _SpiralSlipstream:
    """Elevator effectiveness that varies with a beat of two propellers."""

    def __init__(self, share: float, frequency_hz: float, trim: float) -> None:
        self.share, self.omega, self.trim = share, 2 * math.pi * frequency_hz, trim

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        beat = math.sin(self.omega * time_s)
        return 0.0, -1.1 * self.share * beat * (motion.elevator - self.trim)


def _hunting(kit: Kit, s: Sizes) -> None:
    kit.fittings.mechanisms.append(_LimitCycle(s["amplitude_rad"], s["frequency_hz"]))


def _stiction(kit: Kit, s: Sizes) -> None:
    kit.fittings.mechanisms.append(Stiction(s["breakaway_rad"]))


def _shear(kit: Kit, s: Sizes) -> None:
    kit.fittings.air.append(WindShear(s["gradient_1_s"], kit.height_m))


def _sticky(kit: Kit, s: Sizes) -> None:
    kit.fittings.sensors.append(_StickyVane(s["hold_rad"]))


def _spikes(kit: Kit, s: Sizes) -> None:
    generator = np.random.default_rng([kit.seed, 41])
    kit.fittings.sensors.append(_Spikes(s["height_rad"], s["each_s"], generator))


def _ageing(kit: Kit, s: Sizes) -> None:
    kit.fittings.sensors.append(_AgeingVane(s["growth"]))


def _vane_stops(kit: Kit, s: Sizes) -> None:
    top = kit.trim_alpha + s["above_trim_rad"]
    kit.fittings.sensors.append(Transformed("alpha", lambda value, motion: min(value, top)))


def _gyro_clips(kit: Kit, s: Sizes) -> None:
    most = s["limit_rad_s"]
    kit.fittings.sensors.append(Transformed("q", lambda value, motion: min(max(value, -most), most)))


def _gyro_coarse(kit: Kit, s: Sizes) -> None:
    step = s["step_rad_s"]
    kit.fittings.sensors.append(Transformed("q", lambda value, motion: step * round(value / step)))


def _gyro_feels_g(kit: Kit, s: Sizes) -> None:
    gain = s["per_m2_s4"]
    kit.fittings.sensors.append(
        Transformed("q", lambda value, motion: value + gain * (motion.a_z + GRAVITY_M_S2) ** 2)
    )


def _accelerometer_clips(kit: Kit, s: Sizes) -> None:
    most = s["above_1g_m_s2"] + GRAVITY_M_S2
    kit.fittings.sensors.append(Transformed("a_z", lambda value, motion: max(value, -most)))


def _accelerometer_rectifies(kit: Kit, s: Sizes) -> None:
    gain = s["per_m_s2"]
    kit.fittings.sensors.append(
        Transformed("a_z", lambda value, motion: value + gain * (motion.a_z + GRAVITY_M_S2) ** 2)
    )


def _slosh(kit: Kit, s: Sizes) -> None:
    kit.fittings.forces.append(_Slosh(s["cm"], s["frequency_hz"], s["damping"]))


def _asymmetric(kit: Kit, s: Sizes) -> None:
    kit.fittings.forces.append(_AsymmetricDamping(s["cm_per_rad_s"]))


def _hysteresis(kit: Kit, s: Sizes) -> None:
    kit.fittings.forces.append(_StallHysteresis(s["cl_loss"], s["band_rad"]))


def _buzz(kit: Kit, s: Sizes) -> None:
    kit.fittings.forces.append(_Buzz(s["cm"], s["frequency_hz"]))


def _slipstream(kit: Kit, s: Sizes) -> None:
    kit.fittings.forces.append(_SpiralSlipstream(s["share"], s["frequency_hz"], kit.trim.elevator))


OUTSIDE: dict[str, Kind] = {
    "servo_hunting": Kind("input", {"amplitude_rad": 0.006, "frequency_hz": 1.7}, _hunting),
    "servo_stiction": Kind("input", {"breakaway_rad": 0.012}, _stiction),
    "wind_shear": Kind("air", {"gradient_1_s": 0.25}, _shear),
    "sticky_vane": Kind("alpha_sensor", {"hold_rad": 0.01}, _sticky),
    "alpha_spikes": Kind("alpha_sensor", {"height_rad": 0.02, "each_s": 1.5}, _spikes),
    "vane_ageing": Kind("alpha_sensor", {"growth": 1e-3}, _ageing),
    "vane_stop": Kind("alpha_sensor", {"above_trim_rad": 0.02}, _vane_stops),
    "gyro_saturation": Kind("pitch_rate_sensor", {"limit_rad_s": 0.2}, _gyro_clips),
    "gyro_quantisation": Kind("pitch_rate_sensor", {"step_rad_s": 0.05}, _gyro_coarse),
    "gyro_g_sensitivity": Kind("pitch_rate_sensor", {"per_m2_s4": 0.002}, _gyro_feels_g),
    "accelerometer_saturation": Kind("accelerometer", {"above_1g_m_s2": 2.0}, _accelerometer_clips),
    "accelerometer_rectification": Kind("accelerometer", {"per_m_s2": 0.03}, _accelerometer_rectifies),
    "fuel_slosh": Kind(
        "moment_equation", {"cm": 0.15, "frequency_hz": 1.0, "damping": 0.03}, _slosh, nonlinear_only=True
    ),
    "asymmetric_damping": Kind("moment_equation", {"cm_per_rad_s": 0.06}, _asymmetric, nonlinear_only=True),
    "stall_hysteresis": Kind(
        "force_equation", {"cl_loss": 0.06, "band_rad": 0.025}, _hysteresis, nonlinear_only=True
    ),
    "propeller_buzz": Kind("moment_equation", {"cm": 0.004, "frequency_hz": 1.3}, _buzz, nonlinear_only=True),
    "slipstream_beat": Kind(
        "moment_equation", {"share": 0.4, "frequency_hz": 0.9}, _slipstream, nonlinear_only=True
    ),
}
"""Component of each effect, by the effect's name. The gap diagnosis has none of these names."""
