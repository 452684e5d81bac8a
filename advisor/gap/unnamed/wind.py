"""Does the wind change with height? The air speed against the accelerations, without any aerodynamics.

In air that moves steadily the air speed changes as the accelerometers have it. Where the wind changes with
height, it changes by the gradient times the climb besides. Of both, a parabola in time is taken out of
every manoeuvre: the drift of the integral, and the slow wandering of the wind.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated, speed_rate

_NEEDED = ("airspeed", "a_x", "a_z", "theta", "alpha")
_LEAST_SAMPLES = 10
"""Of the air speed in a manoeuvre, beyond the parabola's three."""
_LEAST_PER_S = 0.1
"""Change of the wind, m/s per metre, from which on it is felt: a knot in five metres."""
_LEAST_MANEUVERS = 4
"""That must agree on a gradient."""
_CHANCE = 1e-3
"""Of a gradient that large by the scatter between so many manoeuvres (Student's t) ..."""
_PLAIN_CHANCE = 5e-3
"""... and the same where heights explain a plain share."""
_LEAST_SHARE = 0.17
"""Of what the air speed has beyond the accelerations. In air that moves, and where thrust comes late, heights
explain up to a seventh of it by chance; a wind that changes with height, a fifth and more ..."""
_PLAIN_SHARE = 0.25
"""... and in air that moves of itself, from this share on it is plain all the same ..."""
_SURE_CHANCE = 1e-4
"""... or where manoeuvres agree as they would with this chance."""


@dataclass(frozen=True)
class Shear:
    """Wind that changes with height."""

    gradient_per_s: float
    """Change of the air speed per metre climbed, 1/s."""
    std: float
    """From leaving out one manoeuvre after the other."""
    share: float
    """Of what the air speed has beyond the accelerations, that heights explain."""
    maneuvers: int
    """That it was found in."""

    @property
    def is_plain(self) -> bool:
        """Beyond what moving air feigns."""
        return self.share >= _PLAIN_SHARE or self.is_agreed(_SURE_CHANCE)

    def is_agreed(self, chance: float) -> bool:
        """Whether the manoeuvres agree on it, and it is felt."""
        scatter = float(stdtrit(self.maneuvers - 1, 1.0 - 0.5 * chance)) * self.std
        return abs(self.gradient_per_s) >= max(_LEAST_PER_S, scatter)


def wind_shear(maneuvers: Sequence[Maneuver]) -> Shear | None:
    """The gradient of the wind when it is there; None when the air speed follows from the accelerations.

    Wind may change in a layer only: then manoeuvres that follow one another in height agree on it.
    """
    apart = [(_height_of(m), p) for m, p in ((m, _apart(m)) for m in maneuvers) if p is not None]
    pairs = [p for _, p in sorted(apart, key=lambda found: found[0])]
    if len(pairs) < _LEAST_MANEUVERS:
        return None
    everywhere = _gradient(pairs)
    chance = _PLAIN_CHANCE if everywhere.share >= _PLAIN_SHARE else _CHANCE
    if everywhere.share >= _LEAST_SHARE and everywhere.is_agreed(chance):
        return everywhere
    if any(np.isnan(height) for height, _ in apart):
        return None
    sizes = range(_LEAST_MANEUVERS, len(pairs))
    layers = [pairs[i : i + size] for size in sizes for i in range(len(pairs) - size + 1)]
    # With so many layers to choose from, one must be as much less likely by chance, and plain.
    found = map(_gradient, layers)
    there = [s for s in found if s.share >= _PLAIN_SHARE and s.is_agreed(_CHANCE / len(layers))]
    return max(there, key=lambda s: abs(s.gradient_per_s) / max(s.std, 1e-12), default=None)


def _gradient(pairs: Sequence[tuple[FloatArray, FloatArray]]) -> Shear:
    """The gradient over some manoeuvres."""
    products = np.array([float(height @ speed) for height, speed in pairs])
    squares = np.array([float(height @ height) for height, _ in pairs])
    gradient = float(np.sum(products) / np.sum(squares))
    without = (np.sum(products) - products) / (np.sum(squares) - squares)
    n = len(pairs)
    std = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    power = sum(float(speed @ speed) for _, speed in pairs)
    return Shear(gradient, std, gradient * float(np.sum(products)) / max(power, 1e-300), n)


def _height_of(maneuver: Maneuver) -> float:
    """Mean height, m; NaN without one."""
    height = maneuver.channels.get("height")
    return float("nan") if height is None or not len(height) else float(np.mean(height.y))


def _apart(maneuver: Maneuver) -> tuple[FloatArray, FloatArray] | None:
    """Height, and what the air speed has beyond the accelerations, both shape (n,), a parabola taken out."""
    found = maneuver.channels
    if not all(name in found and len(found[name]) > _LEAST_SAMPLES for name in _NEEDED):
        return None
    t = found["a_z"].t
    a_x, theta, alpha, speed = (
        np.interp(t, found[c].t, found[c].y) for c in ("a_x", "theta", "alpha", "airspeed")
    )
    known = integrated(t, speed_rate(a_x, found["a_z"].y, theta, alpha))
    height = integrated(t, speed * np.sin(theta - alpha))
    stamps = found["airspeed"].t
    inside = (stamps >= t[0]) & (stamps <= t[-1])
    if np.count_nonzero(inside) < _LEAST_SAMPLES:
        return None
    stamps, measured = stamps[inside], found["airspeed"].y[inside]
    parabola = np.linalg.qr(np.vander((stamps - stamps[0]) / (stamps[-1] - stamps[0]), 3))[0]

    def freed(y: FloatArray) -> FloatArray:
        return np.asarray(y - parabola @ (parabola.T @ y))

    return freed(np.interp(stamps, t, height)), freed(measured - np.interp(stamps, t, known))
