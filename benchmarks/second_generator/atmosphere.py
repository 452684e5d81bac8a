"""Moving air along the flight path: Dryden turbulence and the single events a pilot meets."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from .kernel import Floats


@dataclass(frozen=True)
class Air:
    """Winds along the path [m/s]: upward, from behind; and the pitch rate they amount to [rad/s]."""

    upward: Floats
    behind: Floats
    pitching: Floats

    def plus(self, other: "Air") -> "Air":
        """Both at once."""
        return Air(self.upward + other.upward, self.behind + other.behind, self.pitching + other.pitching)


def still_air(count: int) -> Air:
    """No wind at all."""
    return Air(np.zeros(count), np.zeros(count), np.zeros(count))


def from_upward(upward: Floats, step: float, airspeed: float, span: float) -> Air:
    """Air with a vertical wind only, and the pitching that its gradient along the path brings.

    A tail in air that rises less than the wing's does feels a nose that goes up: the pitch rate is minus the
    gradient. The aircraft's length smooths it; MIL-F-8785C takes pi V / (4 b) as the corner frequency.
    """
    gradient = -np.gradient(upward, step) / airspeed
    decay = np.exp(-step * np.pi * airspeed / (4.0 * span))
    pitching = lfilter([1.0 - decay], [1.0, -decay], gradient)
    return Air(upward, np.zeros_like(upward), pitching)


def dryden(
    rng: np.random.Generator,
    count: int,
    step: float,
    airspeed: float,
    rms: tuple[float, float],
    scale: float,
    span: float,
) -> Air:
    """Dryden turbulence (MIL-F-8785C): `rms` upward and along the path [m/s], one length scale [m].

    The vertical spectrum has a double pole and a zero, the longitudinal one a single pole. Each series is
    brought to its rms, so that the key says what really blew.
    """
    decay = np.exp(-step * airspeed / scale)
    white = rng.standard_normal((2, count))
    lagged = lfilter([1.0 - decay], [1.0, -decay], white[0])
    # (1 + sqrt(3) s L/V) / (1 + s L/V)^2 is a lag plus sqrt(3) times its complement, lagged once more.
    slope = np.sqrt(3.0)
    twice = lfilter([1.0 - decay], [1.0, -decay], lagged)
    upward = slope * lagged + (1.0 - slope) * twice
    along = lfilter([1.0 - decay], [1.0, -decay], white[1])
    vertical = from_upward(upward * rms[0] / np.std(upward), step, airspeed, span)
    return Air(vertical.upward, along * rms[1] / np.std(along), vertical.pitching)


def one_minus_cosine(time: Floats, start: float, duration: float, size: float) -> Floats:
    """A discrete gust of height `size` [m/s] that lasts `duration` [s] (CS-25.341)."""
    phase = np.clip((time - start) / duration, 0.0, 1.0)
    wind: Floats = 0.5 * size * (1.0 - np.cos(2.0 * np.pi * phase))
    return wind


def thermal(time: Floats, centre: float, width: float, size: float) -> Floats:
    """A thermal's core with its ring of sinking air [m/s]: the second derivative of a bell."""
    off = (time - centre) / width
    wind: Floats = size * (1.0 - off**2) * np.exp(-0.5 * off**2)
    return wind


def mountain_wave(time: Floats, period: float, size: float, phase: float) -> Floats:
    """A standing wave flown through, with the sharper crests that its third harmonic gives [m/s]."""
    turn = 2.0 * np.pi * time / period + phase
    wind: Floats = size * (np.sin(turn) + 0.3 * np.sin(3.0 * turn))
    return wind


def wake_crossing(time: Floats, centre: float, core: float, size: float) -> Floats:
    """Crossing another aircraft's two vortices: up, sharply down between the cores, up again [m/s]."""
    left, right = (time - centre) / core + 2.0, (time - centre) / core - 2.0
    return -size * (left / (1.0 + left**2) - right / (1.0 + right**2)) * 1.6
