"""Path of the elevator from command to surface: pulse width, servo dynamics, stops."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol


class Mechanism(Protocol):
    """One stage between command and surface, stepped with the simulation."""

    def reset(self, value: float) -> None:
        """Set the stage to rest at ``value`` (rad)."""
        ...

    def step(self, value: float, dt: float) -> float:
        """Return the output in rad after ``dt`` seconds in which the input moved linearly to ``value``."""
        ...


@dataclass(frozen=True)
class Calibration:
    """Deflection for a pulse width, with straight lines between points and no extrapolation."""

    points: tuple[tuple[float, float], ...] = ((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))
    """Pairs (µs, deg trailing edge down) with rising pulse widths."""

    @property
    def low_us(self) -> int:
        """Smallest pulse width of the calibration, µs."""
        return round(self.points[0][0])

    @property
    def high_us(self) -> int:
        """Largest pulse width of the calibration, µs."""
        return round(self.points[-1][0])

    @property
    def trim_us(self) -> int:
        """Pulse width of the neutral surface, µs."""
        return self.pulse(0.0)

    def pulse(self, deflection: float) -> int:
        """Return the nearest whole pulse width in µs for a deflection in rad, within the stops."""
        pairs = sorted((math.radians(angle), pulse) for pulse, angle in self.points)
        return round(_between(pairs, deflection))

    def deflection(self, pulse_us: int) -> float:
        """Return the deflection in rad that a pulse width commands."""
        return math.radians(_between(self.points, pulse_us))


def _between(pairs: Sequence[tuple[float, float]], at: float) -> float:
    """Interpolate linearly in rising pairs (x, y). Beyond the pairs, the end values are used."""
    if at <= pairs[0][0]:
        return pairs[0][1]
    for (x0, y0), (x1, y1) in pairwise(pairs):
        if at <= x1:
            return y0 + (y1 - y0) * (at - x0) / (x1 - x0)
    return pairs[-1][1]


class FirstOrderServo:
    """First-order servo τ δ̇ = u − δ, solved exactly for an input that is linear over the step."""

    def __init__(self, lag_s: float) -> None:
        self.lag_s = lag_s
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the servo to rest at ``value`` (rad)."""
        self._input = self._output = value

    def step(self, value: float, dt: float) -> float:
        """Return the servo's deflection after ``dt`` s, rad."""
        slope = (value - self._input) / dt
        # Response to a ramp: the steady state lags behind the input by τ times its slope.
        trailing = value - self.lag_s * slope
        error = self._output - (self._input - self.lag_s * slope)
        self._output = trailing + error * math.exp(-dt / self.lag_s)
        self._input = value
        return self._output


class SecondOrderServo:
    """Second-order servo δ̈ + 2ζω δ̇ + ω² δ = ω² u with a rate limit, in quarter steps of semi-implicit
    Euler."""

    def __init__(self, frequency_hz: float, damping: float, rate_limit_rad_s: float = math.inf) -> None:
        self.omega = 2 * math.pi * frequency_hz
        self.damping = damping
        self.rate_limit = rate_limit_rad_s
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the servo to rest at ``value`` (rad)."""
        self._position, self._rate = value, 0.0

    def step(self, value: float, dt: float) -> float:
        """Return the servo's deflection after ``dt`` s, rad."""
        pieces = 4
        for _ in range(pieces):
            pull = self.omega**2 * (value - self._position) - 2 * self.damping * self.omega * self._rate
            rate = self._rate + pull * dt / pieces
            self._rate = min(max(rate, -self.rate_limit), self.rate_limit)
            self._position += self._rate * dt / pieces
        return self._position


class TransportDelay:
    """Transport delay δ(t) = u(t − T): a queue of past inputs with interpolation."""

    def __init__(self, delay_s: float) -> None:
        self.delay_s = delay_s
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the whole past of the input to ``value`` (rad)."""
        self._past = [value]
        self._resting = value

    def step(self, value: float, dt: float) -> float:
        """Return the input of ``delay_s`` ago, rad."""
        self._past.append(value)
        back = self.delay_s / dt
        whole = int(back)
        if len(self._past) <= whole + 1:
            return self._resting
        share = back - whole
        late = self._past[-1 - whole] * (1 - share) + self._past[-2 - whole] * share
        if len(self._past) > 4 * whole + 1000:
            del self._past[: -2 * whole - 10]
        return late


class Servo:
    """Stages in series, from command to surface."""

    def __init__(self, stages: tuple[Mechanism, ...]) -> None:
        self.stages = stages

    def reset(self, value: float) -> None:
        """Set all stages to rest at ``value`` (rad)."""
        for stage in self.stages:
            stage.reset(value)

    def step(self, value: float, dt: float) -> float:
        """Return the surface's deflection after ``dt`` s, rad."""
        for stage in self.stages:
            value = stage.step(value, dt)
        return value
