"""Wind shear: the air speed compared with the accelerations, without aerodynamics.

In steadily moving air the air speed changes by the integral of the accelerations. With wind shear the air
speed also changes by the gradient times the climb, everywhere or in a layer. A parabola in time is removed
from every manoeuvre, for the drift of the integral and for slow changes of the wind.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.motion import channel_at, gravity_in_plane, integrated, speed_rate
from advisor.gap.decision import SIGMAS
from advisor.process.arrays import FloatArray

_NEEDED = ("airspeed", "a_x", "a_z", "theta", "alpha")
_LEAST_SAMPLES = 10
"""Record: least number of air speed samples in a manoeuvre, beyond the parabola's three parameters."""
_LEAST_PER_S = 0.08
"""Least wind gradient, 1/s, that is reported: a knot in six metres."""
_MOST_PER_S = 0.5
"""Prior: largest gradient of a wind, 1/s. Wind shear that airports call severe begins at 0.2 1/s (ICAO Doc
9817)."""
_LEAST_MANEUVERS = 4
"""Record: least number of manoeuvres that must agree on a wind gradient."""
_LEAST_SHARE = 0.17
"""Least share of the air speed's residual that heights must explain. In 770 simulated flights, in moving air
and with delayed thrust, heights explained up to a seventh by chance. A wind gradient explains a fifth and
more."""
_ALONE = 1e-3
"""Numerical: least share of the squared height changes in all manoeuvres but one, for the scatter."""
_LATE_S = (0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Numerical: candidate delays of the air speed, s, by a long pressure line and a filter."""
_HEIGHTS = 14
_THINNEST_M = 2.0
"""Numerical: least thickness of a layer, m. Candidate layers lie between any two of ``_HEIGHTS`` quantiles of
the height."""


@dataclass(frozen=True)
class Shear:
    """Wind shear: a wind that changes with height."""

    gradient_per_s: float
    """Change of the air speed per metre climbed, 1/s."""
    std: float
    """Standard deviation of the gradient by leaving out each manoeuvre in turn, 1/s."""
    share: float
    """Share of the air speed's residual, after the accelerations, that heights explain."""
    maneuvers: int
    """Number of manoeuvres that determine the gradient."""

    @property
    def is_implausible(self) -> bool:
        """Whether the gradient exceeds that of any wind, as with a gust or a wrong air speed."""
        return abs(self.gradient_per_s) > _MOST_PER_S

    @property
    def is_agreed(self) -> bool:
        """Whether the manoeuvres agree on a gradient that matters."""
        least = max(_LEAST_PER_S, SIGMAS * self.std)
        return self.share >= _LEAST_SHARE and abs(self.gradient_per_s) >= least


@dataclass(frozen=True)
class _Path:
    """Path and air speed of one manoeuvre, each of shape (n,), at the stamps of the air speed."""

    height: FloatArray
    """Height, m; NaN where it was not measured."""
    climbed: FloatArray
    """Climbed height without its parabola in time, m."""
    speed: FloatArray
    """Air speed minus the integral of the accelerations, without the parabola, m/s."""
    parabola: FloatArray
    """Shape (n, 3): orthonormal basis of the parabola."""

    def freed(self, y: FloatArray) -> FloatArray:
        """Return a time series without its parabola."""
        return np.asarray(y - self.parabola @ (self.parabola.T @ y))


def wind_shear(maneuvers: Sequence[Maneuver], true_over_read: float = 1.0) -> Shear | None:
    """Return the gradient of the wind; None if the accelerations explain the air speed.

    The effect of a wind that changes in one layer depends on the height of every sample.

    Parameters
    ----------
    maneuvers
        Manoeuvres of the flight; those without the path's channels are ignored.
    true_over_read
        Ratio of the true air speed to the read air speed.
    """
    shear = _shear_of(_paths_of(maneuvers))
    if shear is None:
        return None
    # A late instrument, or an indicated air speed, imitates a wind gradient as well.
    unexplained_power = [
        _unexplained(_paths_of(maneuvers, true_over_read, late_s, _LATE_S[-1])) for late_s in _LATE_S
    ]
    return _shear_of(_paths_of(maneuvers, true_over_read, _LATE_S[int(np.argmin(unexplained_power))]))


def _shear_of(paths: Sequence[_Path]) -> Shear | None:
    """Return the wind gradient everywhere or in the likeliest layer; None without a gradient."""
    if len(paths) < _LEAST_MANEUVERS:
        return None
    everywhere = _gradient(paths)
    if everywhere.is_agreed:
        return everywhere
    heights = np.concatenate([p.height for p in paths])
    if np.any(np.isnan(heights)):
        return None
    between = combinations(np.quantile(heights, np.linspace(0.0, 1.0, _HEIGHTS)), 2)
    layers = [_gradient(paths, low, high) for low, high in between if high - low >= _THINNEST_M]
    likeliest = max(layers, key=lambda s: s.share, default=everywhere)
    return likeliest if likeliest.is_agreed else None


def _gradient(paths: Sequence[_Path], low: float = -np.inf, high: float = np.inf) -> Shear:
    """Return the wind gradient over all manoeuvres, for a wind that changes between two heights only."""
    whole = not np.isfinite(high - low)
    winds = [p.climbed if whole else p.freed(np.clip(p.height, low, high)) for p in paths]
    products = np.array([float(w @ p.speed) for w, p in zip(winds, paths, strict=True)])
    squares = np.array([float(w @ w) for w in winds])
    n, rest = len(paths), np.sum(squares) - squares
    if np.min(rest) <= _ALONE * np.sum(squares):
        # A single informative manoeuvre agrees with no other.
        return Shear(0.0, np.inf, 0.0, n)
    gradient = float(np.sum(products) / np.sum(squares))
    without = (np.sum(products) - products) / rest
    std = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    power = sum(float(p.speed @ p.speed) for p in paths)
    return Shear(gradient, std, gradient * float(np.sum(products)) / max(power, 1e-300), n)


def _paths_of(
    maneuvers: Sequence[Maneuver], true_over_read: float = 1.0, late_s: float = 0.0, skipped_s: float = 0.0
) -> list[_Path]:
    paths = (_path_of(m, true_over_read, late_s, skipped_s) for m in maneuvers)
    return [p for p in paths if p is not None]


def _unexplained(paths: Sequence[_Path]) -> float:
    """Return the power of the air speed that neither accelerations nor a wind gradient explain."""
    power = sum(float(p.speed @ p.speed) for p in paths)
    return power * (1.0 - max(_gradient(paths).share, 0.0))


def _path_of(
    maneuver: Maneuver, true_over_read: float = 1.0, late_s: float = 0.0, skipped_s: float = 0.0
) -> _Path | None:
    """Return path and air speed of a manoeuvre with a late sensor; None without channels or samples."""
    channels = maneuver.channels
    if not all(name in channels and len(channels[name]) > _LEAST_SAMPLES for name in _NEEDED):
        return None
    t = channels["a_z"].t
    a_x, theta, alpha, speed = (
        np.interp(t, channels[c].t, channels[c].y) for c in ("a_x", "theta", "alpha", "airspeed")
    )
    bank = channel_at("bank", t, channels)
    rate = speed_rate(a_x, channels["a_z"].y, theta, alpha, bank) / true_over_read
    up, size = gravity_in_plane(theta, bank)
    climbed = integrated(t, speed * size / GRAVITY_M_S2 * np.sin(up - alpha))
    stamps = channels["airspeed"].t
    inside = (stamps >= t[0] + max(late_s, skipped_s)) & (stamps <= t[-1])
    if np.count_nonzero(inside) < _LEAST_SAMPLES:
        return None
    stamps, measured = stamps[inside], channels["airspeed"].y[inside]
    # Barometers are coarse and late: they give the height of a manoeuvre, not its climb.
    height, begun = channels.get("height"), np.nan
    if height is not None and len(height):
        begun = float(np.mean(height.y - np.interp(height.t, t, climbed)))
    gained, climbed = (np.interp(stamps - late_s, t, y) for y in (integrated(t, rate), climbed))
    parabola = np.linalg.qr(np.vander((stamps - stamps[0]) / (stamps[-1] - stamps[0]), 3))[0]
    path = _Path(climbed + begun, climbed, measured - gained, parabola)
    return replace(path, climbed=path.freed(climbed), speed=path.freed(path.speed))
