"""Does the wind change with height? The air speed against the accelerations, without any aerodynamics.

In air that moves steadily the air speed changes as the accelerometers have it. Where the wind changes with
height, it changes by the gradient times the climb besides: everywhere, or in a layer above and below which
the wind is the same. Of both, a parabola in time is taken out of every manoeuvre: the drift of the integral,
and the slow wandering of the wind.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.special import stdtrit

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import bank_at, gravity_in_plane, integrated, speed_rate
from advisor.standard_gravity import GRAVITY_M_S2

_NEEDED = ("airspeed", "a_x", "a_z", "theta", "alpha")
_LEAST_SAMPLES = 10
"""Of the air speed in a manoeuvre, beyond the parabola's three."""
_LEAST_PER_S = 0.08
"""Change of the wind, m/s per metre, from which on it is felt: a knot in six metres."""
_MOST_PER_S = 0.5
"""A wind shear that airports call severe begins at 0.2 1/s (ICAO Doc 9817)."""
_LEAST_MANEUVERS = 4
"""That must agree on a gradient."""
_CHANCE = 1e-3
"""Of a gradient that large by the scatter between so many manoeuvres (Student's t) ..."""
_CLEAR_CHANCE = 5e-3
"""... and the same where heights explain a plain share."""
_LEAST_SHARE = 0.17
"""Of what the air speed has beyond the accelerations. In air that moves, and where thrust comes late, heights
explain up to a seventh of it by chance; a wind that changes with height, a fifth and more ..."""
_CLEAR_SHARE = 0.25
"""... and in air that moves of itself, from this share on it is plain all the same ..."""
_SURE_CHANCE = 1e-4
"""... or where manoeuvres agree as they would with this chance."""
_LAYER_CHANCE, _LAYER_SHARE = 1e-2, 0.3
"""Of a layer's gradient: few manoeuvres tell of a layer, and leaving one of them out scatters by much. In 770
flights of simulators without it two layers explain 0.25 and none more, but where an attitude was wrong."""
_UNDENIABLE_SHARE = 0.4
"""Far beyond all of these: then few manoeuvres may have met the layer ..."""
_NOT_ONE_ALONE = 1.5
"""... but not one, left out without which nothing of a gradient stays: it is its own scatter then."""
_ALONG, _ABOVE_NOISE = 0.015, 3.0
"""Swing of the air speed in a usual manoeuvre, relative, and beside its white noise."""
_ALONE = 1e-3
"""Share of the heights' changes that all manoeuvres but one must hold."""
_LATE_S = (0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0)
"""By which an air speed may be late: a long line to the tube, and a filter."""
_HEIGHTS = 14
_THINNEST_M = 2.0
"""Heights between which a layer is sought, as many in every part of what was flown; and the least of one."""


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
    def is_implausible(self) -> bool:
        """Whether no wind changes by that much: in moving air its gusts, else an air speed that is wrong."""
        return abs(self.gradient_per_s) > _MOST_PER_S

    @property
    def exceeds_gusts(self) -> bool:
        """Beyond what moving air feigns."""
        return self.share >= _CLEAR_SHARE or self.is_agreed(_SURE_CHANCE)

    def is_agreed(self, chance: float) -> bool:
        """Whether the manoeuvres agree on it, and it is felt."""
        scatter = float(stdtrit(self.maneuvers - 1, 1.0 - 0.5 * chance)) * self.std
        return abs(self.gradient_per_s) >= max(_LEAST_PER_S, scatter)


@dataclass(frozen=True)
class _Path:
    """What one manoeuvre tells, shape (n,) each, at the stamps of the air speed."""

    height: FloatArray
    """m; NaN where none was measured."""
    climbed: FloatArray
    """m, without the parabola."""
    speed: FloatArray
    """Air speed beyond the accelerations, m/s, without the parabola."""
    parabola: FloatArray
    """Shape (n, 3): orthonormal."""

    def freed(self, y: FloatArray) -> FloatArray:
        """A course without its parabola."""
        return np.asarray(y - self.parabola @ (self.parabola.T @ y))


def wind_shear(maneuvers: Sequence[Maneuver], true_over_read: float = 1.0) -> Shear | None:
    """The gradient of the wind when it is there; None when the air speed follows from the accelerations.

    Wind may change in a layer only: then the height of every sample says what it does.

    Parameters
    ----------
    maneuvers
        With the channels that the path is computed from; others do not count.
    true_over_read
        How many times the air speed that is read the true one is.
    """
    found = _shear_of(_paths_of(maneuvers))
    if found is None:
        return None
    # An instrument that is late, or indicates less than the true speed, feigns wind as well.
    unexplained_power = [
        _unexplained(_paths_of(maneuvers, true_over_read, late_s, _LATE_S[-1])) for late_s in _LATE_S
    ]
    return _shear_of(_paths_of(maneuvers, true_over_read, _LATE_S[int(np.argmin(unexplained_power))]))


def _shear_of(paths: Sequence[_Path]) -> Shear | None:
    """The gradient everywhere, or in the likeliest layer; None where there is none."""
    if len(paths) < _LEAST_MANEUVERS:
        return None
    everywhere = _gradient(paths)
    chance = _CLEAR_CHANCE if everywhere.share >= _CLEAR_SHARE else _CHANCE
    if everywhere.share >= _LEAST_SHARE and everywhere.is_agreed(chance):
        return everywhere
    heights = np.concatenate([p.height for p in paths])
    if np.any(np.isnan(heights)):
        return None
    between = combinations(np.quantile(heights, np.linspace(0.0, 1.0, _HEIGHTS)), 2)
    layers = [_gradient(paths, low, high) for low, high in between if high - low >= _THINNEST_M]
    likeliest = max(layers, key=lambda s: s.share, default=everywhere)
    there = likeliest.share >= _LAYER_SHARE and likeliest.is_agreed(_LAYER_CHANCE)
    gradient = abs(likeliest.gradient_per_s)
    undeniable = likeliest.share >= _UNDENIABLE_SHARE and gradient >= max(
        _LEAST_PER_S, _NOT_ONE_ALONE * likeliest.std
    )
    return likeliest if there or undeniable else None


def moves_along_path(maneuvers: Sequence[Maneuver]) -> bool:
    """Whether the air speed swings beyond the accelerations by more than its noise: air moves along the path.

    Found in 3 of 480 flights, all in gusts, and in one whose attitude was wrong.
    """
    slow, above_noise = [], []
    for maneuver in maneuvers:
        path = _path_of(maneuver)
        if path is None:
            continue
        white = float(np.var(np.diff(path.speed))) / 2.0
        swing = float(np.sqrt(max(float(np.var(path.speed)) - white, 0.0)))
        slow.append(swing / float(np.mean(maneuver.channels["airspeed"].y)))
        above_noise.append(swing / max(np.sqrt(white), 1e-12))
    enough = len(slow) >= _LEAST_MANEUVERS
    return enough and bool(np.median(slow) > _ALONG and np.median(above_noise) > _ABOVE_NOISE)


def _gradient(paths: Sequence[_Path], low: float = -np.inf, high: float = np.inf) -> Shear:
    """The gradient over all manoeuvres, of a wind that changes between two heights only."""
    whole = not np.isfinite(high - low)
    winds = [p.climbed if whole else p.freed(np.clip(p.height, low, high)) for p in paths]
    products = np.array([float(w @ p.speed) for w, p in zip(winds, paths, strict=True)])
    squares = np.array([float(w @ w) for w in winds])
    n, rest = len(paths), np.sum(squares) - squares
    if np.min(rest) <= _ALONE * np.sum(squares):
        # One manoeuvre that tells alone agrees with no other.
        return Shear(0.0, np.inf, 0.0, n)
    gradient = float(np.sum(products) / np.sum(squares))
    without = (np.sum(products) - products) / rest
    std = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    power = sum(float(p.speed @ p.speed) for p in paths)
    return Shear(gradient, std, gradient * float(np.sum(products)) / max(power, 1e-300), n)


def _paths_of(
    maneuvers: Sequence[Maneuver], true_over_read: float = 1.0, late_s: float = 0.0, skipped_s: float = 0.0
) -> list[_Path]:
    found = (_path_of(m, true_over_read, late_s, skipped_s) for m in maneuvers)
    return [p for p in found if p is not None]


def _unexplained(paths: Sequence[_Path]) -> float:
    """Power of the air speed that neither accelerations nor a wind that changes with height explain."""
    power = sum(float(p.speed @ p.speed) for p in paths)
    return power * (1.0 - max(_gradient(paths).share, 0.0))


def _path_of(
    maneuver: Maneuver, true_over_read: float = 1.0, late_s: float = 0.0, skipped_s: float = 0.0
) -> _Path | None:
    """What a manoeuvre tells, by an instrument that is late; None without channels, or with few samples.

    ``skipped_s`` of its beginning are left out: what delays leave is compared over the same samples.
    """
    found = maneuver.channels
    if not all(name in found and len(found[name]) > _LEAST_SAMPLES for name in _NEEDED):
        return None
    t = found["a_z"].t
    a_x, theta, alpha, speed = (
        np.interp(t, found[c].t, found[c].y) for c in ("a_x", "theta", "alpha", "airspeed")
    )
    bank = bank_at(t, found)
    rate = speed_rate(a_x, found["a_z"].y, theta, alpha, bank) / true_over_read
    up, size = gravity_in_plane(theta, bank)
    climbed = integrated(t, speed * size / GRAVITY_M_S2 * np.sin(up - alpha))
    stamps = found["airspeed"].t
    inside = (stamps >= t[0] + max(late_s, skipped_s)) & (stamps <= t[-1])
    if np.count_nonzero(inside) < _LEAST_SAMPLES:
        return None
    stamps, measured = stamps[inside], found["airspeed"].y[inside]
    # Barometers are coarse and late: they say how high a manoeuvre was flown, not how it climbed.
    height, begun = found.get("height"), np.nan
    if height is not None and len(height):
        begun = float(np.mean(height.y - np.interp(height.t, t, climbed)))
    known, climbed = (np.interp(stamps - late_s, t, y) for y in (integrated(t, rate), climbed))
    parabola = np.linalg.qr(np.vander((stamps - stamps[0]) / (stamps[-1] - stamps[0]), 3))[0]
    path = _Path(climbed + begun, climbed, measured - known, parabola)
    return replace(path, climbed=path.freed(climbed), speed=path.freed(path.speed))
