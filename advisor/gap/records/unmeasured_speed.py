"""Air speed of a flight without an air speed sensor: level and changes, from the motion.

The factor 1/V turns specific force into rate of α, α̇ − q = (a_z cos α − a_x sin α + g cos(θ − α))/V. The
accelerometers show how V changes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.derived_alpha import channel_at, integrated, path_turning, speed_rate_at
from advisor.gap.decision import SIGMAS
from advisor.process.arrays import FloatArray

_BLOCK_S = 1.0
"""Prior: length in s of the blocks over which motion errors are fully correlated."""
_LARGER = 3.0
"""Prior: factor by which errors may exceed the scatter between blocks, because only α shows gusts."""
_FLOWN = 0.05
"""Prior: prior standard deviation of a manoeuvre's speed about the intended speed, relative."""
_LEAST_STD = 0.01
"""Prior: least standard deviation of a speed from the motion, relative."""


@dataclass(frozen=True)
class Speeds:
    """Speeds of manoeuvres that were flown without an air speed sensor."""

    before_m_s: FloatArray
    """Shape (manoeuvres,): speed before the first step, m/s."""
    std_m_s: FloatArray
    """Shape (manoeuvres,): standard deviation of the speed before the first step, m/s."""
    differ: bool
    """Whether the motion shows that the speeds of the manoeuvres differ."""

    @property
    def moves(self) -> float:
        """Largest relative deviation from the mean speed; 0 where the speeds do not significantly differ."""
        return float(np.max(np.abs(self.before_m_s / np.mean(self.before_m_s) - 1.0))) if self.differ else 0.0


def speed_of_the_motion(maneuvers: Sequence[Maneuver]) -> float | None:
    """Return the air speed in m/s that relates specific force to the rate of α, without an air speed sensor.

    None where a channel is missing, or where the flight shows no force.
    """
    seen = [_turned_and_pushed(m) for m in maneuvers]
    product, square = 0.0, 0.0
    for parts in seen:
        if parts is None:
            return None
        _, turned, pushed = parts
        product += float(turned @ pushed)
        square += float(pushed @ pushed)
    return square / product if product > 0.0 else None


def speeds_about(maneuvers: Sequence[Maneuver], level_m_s: float) -> Speeds:
    """Return the speed of each manoeuvre relative to the intended speed, as far as its motion shows a
    difference.

    A scale error of α or of an accelerometer shifts all speeds equally by some per cent. The mean speed
    therefore stays at the intended speed.
    """
    meant = np.full(len(maneuvers), level_m_s)
    unknown = Speeds(meant, _FLOWN * meant, False)
    inverse, error = [], []
    for maneuver in maneuvers:
        seen = _turned_and_pushed(maneuver, level_m_s)
        if seen is None:
            return unknown
        t, turned, pushed = seen
        square = max(float(pushed @ pushed), 1e-300)
        inverse.append(float(turned @ pushed) / square)
        blocks = ((t - t[0]) / _BLOCK_S).astype(int)
        scores = np.bincount(blocks, pushed * (turned - inverse[-1] * pushed))
        error.append(float(np.sqrt(np.sum(scores**2))) / square)
    shown, errors = np.array(inverse), np.array(error)
    if len(shown) < 2 or np.min(shown) <= 0.0:
        return unknown
    scatter = float(np.std(shown, ddof=1) / np.mean(shown))
    relative = errors / shown
    off, std = np.mean(shown) / shown - 1.0, np.maximum(_LARGER * relative, _LEAST_STD)
    # Gusts spoil what one manoeuvre shows: then it is nearer to what was meant than that.
    weight = _FLOWN**2 / (_FLOWN**2 + std**2)
    differ = scatter > SIGMAS * float(np.sqrt(np.mean(relative**2)))
    return Speeds(meant * (1.0 + weight * off), level_m_s * np.sqrt(weight) * std, differ)


def speed_without_instrument(
    grid: FloatArray, maneuver: Maneuver, start_s: float, level_m_s: float
) -> FloatArray:
    """Return the air speed in m/s at ``grid`` seconds after ``start_s``, shape (n,), from the accelerometers.

    Before the first step the aircraft is trimmed at the steady speed ``level_m_s``: an acceleration there is
    an offset of accelerometers or attitude. The speed is constant where a channel is missing.
    """
    channels = maneuver.channels
    level = np.full(len(grid), level_m_s)
    if not all(name in channels and len(channels[name]) > 10 for name in ("a_x", "a_z", "theta", "alpha")):
        return level
    rate = speed_rate_at(grid + start_s, channels)
    trimmed = grid < maneuver.span.start_s - start_s
    if not np.any(trimmed):
        return level
    return np.maximum(level + integrated(grid, rate - np.mean(rate[trimmed])), 0.5 * level)


def _turned_and_pushed(
    maneuver: Maneuver, level_m_s: float | None = None
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return stamps, and both sides of the integrated equation, the second times V; or None."""
    # Offsets of gyro and accelerometer make a straight line in time, which is removed from both sides.
    channels = maneuver.channels
    if not all(name in channels and len(channels[name]) > 10 for name in ("alpha", "q", "a_z", "theta")):
        return None
    t, alpha = channels["alpha"].t, channels["alpha"].y
    q, a_z, theta = (np.interp(t, channels[name].t, channels[name].y) for name in ("q", "a_z", "theta"))
    a_x = np.interp(t, channels["a_x"].t, channels["a_x"].y) if "a_x" in channels else np.zeros(len(t))
    force = path_turning(a_x, a_z, theta, alpha, channel_at("bank", t, channels))
    if level_m_s is not None:
        force = force * level_m_s / speed_without_instrument(t - t[0], maneuver, float(t[0]), level_m_s)
    line = np.linalg.qr(np.vander(t - t[0], 2))[0]
    turned, pushed = (y - line @ (line.T @ y) for y in (alpha - integrated(t, q), integrated(t, force)))
    return t, turned, pushed
