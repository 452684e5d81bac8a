"""The air speed of a flight that has no instrument for it: its level and changes, as the motion shows them.

What turns specific force into rate of α is 1/V: α̇ − q = (a_z cos α − a_x sin α + g cos(θ − α))/V. From there
the accelerometers show the change.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated, speed_rate
from advisor.gravity import GRAVITY_M_S2

_BLOCK_S = 1.0
"""Over which errors of the motion are one and the same: an offset's remainder, a gust."""
_LARGER = 3.0
"""Errors are up to so many times what blocks of a second show: α sees gusts, the integral does not."""
_APART = 6.0
"""Scatter of the manoeuvres' speeds over what blocks show from which on they differ ..."""
_LEAST_APART, _LEAST_DOUBT = 0.02, 0.01
"""... and the scatter itself, relative; a speed found so is never known better than the second."""


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


def speeds_apart(maneuvers: Sequence[Maneuver], level_m_s: float) -> tuple[FloatArray, float] | None:
    """Speed before each manoeuvre in m/s, shape (manoeuvres,), about a level, and its standard deviation.

    What the motion shows may be off by some per cent in all of them alike, for a scale of α or of an
    accelerometer: the level is left where it is. None where no manoeuvre is told apart from the others.
    """
    inverse, error = [], []
    for maneuver in maneuvers:
        seen = _turned_and_pushed(maneuver, level_m_s)
        if seen is None:
            return None
        t, turned, pushed = seen
        square = float(pushed @ pushed)
        slope = float(turned @ pushed) / max(square, 1e-300)
        blocks = ((t - t[0]) / _BLOCK_S).astype(int)
        scores = np.bincount(blocks, pushed * (turned - slope * pushed))
        inverse.append(slope)
        error.append(float(np.sqrt(np.sum(scores**2))) / max(square, 1e-300))
    shown, errors = np.array(inverse), np.array(error)
    if len(shown) < 2 or np.min(shown) <= 0.0:
        return None
    scatter = float(np.std(shown, ddof=1) / np.mean(shown))
    known = float(np.sqrt(np.mean((errors / shown) ** 2)))
    if scatter < max(_LEAST_APART, _APART * known):
        return None
    speeds: FloatArray = 1.0 / shown
    return level_m_s * speeds / np.mean(speeds), level_m_s * max(_LEAST_DOUBT, _LARGER * known)


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

    def at(name: str) -> FloatArray:
        return np.interp(grid, found[name].t - start_s, found[name].y)

    rate = speed_rate(at("a_x"), at("a_z"), at("theta"), at("alpha"))
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
    force = a_z * np.cos(alpha) - a_x * np.sin(alpha) + GRAVITY_M_S2 * np.cos(theta - alpha)
    if level_m_s is not None:
        force = force * level_m_s / speed_without_instrument(t - t[0], maneuver, float(t[0]), level_m_s)
    line = np.linalg.qr(np.vander(t - t[0], 2))[0]
    turned, pushed = (y - line @ (line.T @ y) for y in (alpha - integrated(t, q), integrated(t, force)))
    return t, turned, pushed
