"""Instruments with errors."""

import math
from collections.abc import Callable

from ..motion import Motion
from ..sensors import Reading
from ..servo import FirstOrderServo


class Lagging:
    """An angle-of-attack vane with inertia and a filter: τ α̇_m = α − α_m."""

    def __init__(self, lag_s: float) -> None:
        self._filter = FirstOrderServo(lag_s)
        self._awake = False

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the reading by a lagged angle of attack."""
        if not self._awake or dt == 0.0:
            self._filter.reset(reading.alpha)
            self._awake = True
            return
        reading.alpha = self._filter.step(reading.alpha, dt)


class Leading:
    """An angle of attack that leads the other channels, because they are filtered more slowly: α + T α̇."""

    def __init__(self, lead_s: float) -> None:
        self.lead_s = lead_s
        self._before: float | None = None

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the reading by an extrapolated angle of attack."""
        now, before = reading.alpha, self._before
        self._before = now
        if before is not None and dt > 0.0:
            reading.alpha = now + self.lead_s * (now - before) / dt


class Scaled:
    """A channel with a scale error and an offset."""

    def __init__(self, channel: str, scale: float = 0.0, bias: float = 0.0) -> None:
        self.channel, self.scale, self.bias = channel, scale, bias

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the reading by (1 + scale) times the truth plus the bias."""
        value = getattr(reading, self.channel)
        setattr(reading, self.channel, (1.0 + self.scale) * value + self.bias)


class VaneAhead:
    """A vane ahead of the centre of gravity, which reads the air due to pitching: α − x q / V."""

    def __init__(self, arm_m: float) -> None:
        self.arm_m = arm_m

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the reading by the angle of attack at the vane."""
        reading.alpha -= self.arm_m * motion.q / motion.airspeed


class BendingMode:
    """A gyro on a fuselage that bends when the elevator loads the tail.

    η̈ + 2ζω η̇ + ω² η = ω² (δ − δ_trim). The gyro turns with the rate of the local slope, q + gain η̇/ω. The
    gyro also reads ``displacement_gain`` η of the bending itself. An attitude integrated from the gyro
    contains the local slope, gain η/ω.
    """

    def __init__(
        self,
        frequency_hz: float,
        damping: float,
        gain: float,
        displacement_gain: float,
        with_attitude: bool = False,
    ) -> None:
        self.omega = 2 * math.pi * frequency_hz
        self.damping, self.gain, self.displacement_gain = damping, gain, displacement_gain
        self.with_attitude = with_attitude
        self._trim: float | None = None
        self._bend = self._rate = 0.0

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Add the bending fuselage's contribution to the pitch rate."""
        if self._trim is None:
            self._trim = motion.elevator
        push = self.omega**2 * (motion.elevator - self._trim - self._bend)
        self._rate += (push - 2 * self.damping * self.omega * self._rate) * dt
        self._bend += self._rate * dt
        reading.q += self.gain * self._rate / self.omega + self.displacement_gain * self._bend
        if self.with_attitude:
            reading.theta += self.gain * self._bend / self.omega


class Transformed:
    """A channel that reads a function of its value and the motion."""

    def __init__(self, channel: str, shown: Callable[[float, Motion], float]) -> None:
        self.channel, self.shown = channel, shown

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the sensor's reading by this effect's function of the true value."""
        setattr(reading, self.channel, self.shown(getattr(reading, self.channel), motion))
