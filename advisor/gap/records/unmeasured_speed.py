"""The air speed of a flight that has no instrument for it: its level and changes, as the motion shows them.

What turns specific force into rate of α is 1/V: α̇ − q = (a_z cos α − a_x sin α + g cos(θ − α))/V. From there
the accelerometers show the change.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import bank_at, integrated, path_turning, speed_rate_at

_BLOCK_S = 1.0
"""Over which errors of the motion are one and the same: an offset's remainder, a gust."""
_LARGER = 3.0
"""Errors are up to so many times what blocks of a second show: α sees gusts, the integral does not."""
_SPEEDS_DIFFER = 6.0
"""Scatter of the manoeuvres' speeds over what blocks show from which on they differ ..."""
_LEAST_DIFFERENCE = 0.02
"""... and the scatter itself, relative."""
_FLOWN = 0.05
"""Standard deviation of the speed that was flown about the one that was meant, relative ..."""
_LEAST_STD = 0.01
"""... and of the best that the motion shows."""


@dataclass(frozen=True)
class Speeds:
    """What is known of the speeds of manoeuvres that were flown without an instrument for them."""

    before_m_s: FloatArray
    """Shape (manoeuvres,): before the first step."""
    std_m_s: FloatArray
    """Shape (manoeuvres,): standard deviation of that."""
    differ: bool
    """Whether the motion shows beyond doubt that they differ."""

    @property
    def moves(self) -> float:
        """Largest relative departure from the mean; 0 where none is certain."""
        return float(np.max(np.abs(self.before_m_s / np.mean(self.before_m_s) - 1.0))) if self.differ else 0.0


def speed_of_the_motion(maneuvers: Sequence[Maneuver]) -> float | None:
    """The air speed in m/s without an instrument for it: what turns specific force into rate of α.

    None where a channel is missing, or the flight shows no force.
    """
    seen = [_turned_and_pushed(m) for m in maneuvers]
    product, square = 0.0, 0.0
    for one in seen:
        if one is None:
            return None
        _, turned, pushed = one
        product += float(turned @ pushed)
        square += float(pushed @ pushed)
    return square / product if product > 0.0 else None


def speeds_about(maneuvers: Sequence[Maneuver], level_m_s: float) -> Speeds:
    """Speeds about the one that was meant, as far as the motion of each manoeuvre shows them.

    What the motion shows may be off by some per cent in all of them alike, for a scale of α or of an
    accelerometer: their mean is left where it is.
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
    known = errors / shown
    off, std = np.mean(shown) / shown - 1.0, np.maximum(_LARGER * known, _LEAST_STD)
    # Gusts spoil what one manoeuvre shows: then it is nearer to what was meant than that.
    weight = _FLOWN**2 / (_FLOWN**2 + std**2)
    differ = scatter > max(_LEAST_DIFFERENCE, _SPEEDS_DIFFER * float(np.sqrt(np.mean(known**2))))
    return Speeds(meant * (1.0 + weight * off), level_m_s * np.sqrt(weight) * std, differ)


def speed_without_instrument(
    grid: FloatArray, maneuver: Maneuver, start_s: float, level_m_s: float
) -> FloatArray:
    """Speed in m/s at ``grid`` seconds after ``start_s``, shape (n,), as the accelerometers show its change.

    Before the first step the aircraft is trimmed and its speed steady, at ``level_m_s``: what is read there
    is an offset of the accelerometers or the attitude. Constant where a channel is missing.
    """
    found = maneuver.channels
    level = np.full(len(grid), level_m_s)
    if not all(name in found and len(found[name]) > 10 for name in ("a_x", "a_z", "theta", "alpha")):
        return level
    rate = speed_rate_at(grid + start_s, found)
    trimmed = grid < maneuver.span.start_s - start_s
    if not np.any(trimmed):
        return level
    return np.maximum(level + integrated(grid, rate - np.mean(rate[trimmed])), 0.5 * level)


def _turned_and_pushed(
    maneuver: Maneuver, level_m_s: float | None = None
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Stamps, and both sides of the equation in integral form, the second times V; None without a channel.

    A straight line in time is taken out of both, which offsets of gyro and accelerometer make. With a level
    the second is times the speed before the first step: what changes from there is made out.
    """
    found = maneuver.channels
    if not all(name in found and len(found[name]) > 10 for name in ("alpha", "q", "a_z", "theta")):
        return None
    t, alpha = found["alpha"].t, found["alpha"].y
    q, a_z, theta = (np.interp(t, found[name].t, found[name].y) for name in ("q", "a_z", "theta"))
    a_x = np.interp(t, found["a_x"].t, found["a_x"].y) if "a_x" in found else np.zeros(len(t))
    force = path_turning(a_x, a_z, theta, alpha, bank_at(t, found))
    if level_m_s is not None:
        force = force * level_m_s / speed_without_instrument(t - t[0], maneuver, float(t[0]), level_m_s)
    line = np.linalg.qr(np.vander(t - t[0], 2))[0]
    turned, pushed = (y - line @ (line.T @ y) for y in (alpha - integrated(t, q), integrated(t, force)))
    return t, turned, pushed
