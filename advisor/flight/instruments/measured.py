"""A measured value with its error, the weighted mean of several values, and hypotheses about an instrument's
scale.

A reading is the true value times a factor: 1 as stated, −1 for a reversed sense, 57.3 for degrees that are
read as radians. Around each factor the scale of an instrument scatters by a known share. All hypotheses have
equal prior probability, and the posterior follows from the likelihoods. One further hypothesis allows any
scale, so that the nearest factor may also be wrong.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, log, pi, sqrt

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.derived_alpha import channel_at, gravity_in_plane
from advisor.process.arrays import FloatArray

_BEGIN_S, _STAYS, _SCATTERS = 1.0, 0.5, 3.0
"""Length of a record's beginning, s; limit as a share; limit in scatters. An offset stays if the beginning's
offset differs from the record's by at most the share of the mean offset. A larger difference must also exceed
the last number of scatters between manoeuvres.
"""


@dataclass(frozen=True, slots=True)
class AlphaOffset:
    """Mean of α minus (θ − flight-path angle), rad, over a manoeuvre. The offset is NaN where unknown."""

    rad: float = float("nan")
    std_rad: float = float("nan")
    change_rad: float = float("nan")
    """Offset over the record minus the offset in its first second; 0 within three times the scatter of
    manoeuvres. An instrument's offset is present from the first second; sinking air comes later."""

    @property
    def stays(self) -> bool:
        """Whether the offset may have been present from the record's beginning."""
        return not abs(self.change_rad) >= _STAYS * abs(self.rad)


UNKNOWN = AlphaOffset()


def offset_of(maneuver: Maneuver, airspeed_m_s: float | None) -> AlphaOffset:
    """Return the mean of α − (θ − γ), its error, and its change, with γ from the climb rate. The offset is
    NaN without a climb rate.

    Parameters
    ----------
    maneuver
        Manoeuvre with channels ``alpha`` and ``theta``. A channel ``bank`` is used if present.
    airspeed_m_s
        Air speed of a log without an air speed, m/s.
    """
    channels = maneuver.channels
    if "climb_rate" not in channels or len(channels["climb_rate"]) < 4:
        return UNKNOWN
    climb = channels["climb_rate"]

    def at(name: str) -> FloatArray:
        return np.interp(climb.t, channels[name].t, channels[name].y)

    speed = speed_at(climb.t, maneuver, airspeed_m_s)
    assert speed is not None
    speed = np.maximum(speed, 1.0)
    up, size = gravity_in_plane(at("theta"), channel_at("bank", climb.t, channels))
    apart = at("alpha") - (up - np.arcsin(np.clip(climb.y / speed * GRAVITY_M_S2 / size, -0.9, 0.9)))
    # The climb rate is slow and smoothed, so that one reading a second counts as independent.
    independent = max(2.0, climb.t[-1] - climb.t[0])
    change = float(np.mean(apart) - np.mean(apart[climb.t <= climb.t[0] + _BEGIN_S]))
    return AlphaOffset(float(np.mean(apart)), float(np.std(apart) / np.sqrt(independent)), change)


def mean_offset(offsets: Sequence[AlphaOffset]) -> AlphaOffset:
    """Return the mean offset for the aircraft from the offsets of its manoeuvres. Unknown offsets are
    ignored."""
    seen = [o for o in offsets if np.isfinite(o.rad)]
    if not seen:
        return UNKNOWN
    changes = np.array([o.change_rad for o in seen])
    scatter = np.std(changes) / np.sqrt(max(len(changes) - 1, 1))
    change = float(np.mean(changes))
    plain = len(changes) > 1 and abs(change) > _SCATTERS * scatter
    return AlphaOffset(*weighted([o.rad for o in seen], [o.std_rad for o in seen]), change if plain else 0.0)


def speed_at(t: FloatArray, maneuver: Maneuver, otherwise: float | None) -> FloatArray | None:
    """Return the logged air speed at ``t``, else the given air speed, shape (n,); None without both."""
    logged = maneuver.channels.get("airspeed")
    if logged is not None and len(logged) > 1:
        return np.interp(t, logged.t, logged.y)
    return None if otherwise is None else np.full(len(t), otherwise)


def weighted(values: Sequence[float], stds: Sequence[float]) -> tuple[float, float]:
    """Return the weighted mean of values and its error, which a larger scatter widens."""
    y, s = np.array(values), np.maximum(np.array(stds), 1e-12)
    w = 1.0 / s**2
    mean = float(np.sum(w * y) / np.sum(w))
    chi2 = float(np.sum(w * (y - mean) ** 2)) / max(len(y) - 1, 1)
    return mean, float(np.sqrt(max(chi2, 1.0) / np.sum(w)))


@dataclass(frozen=True, slots=True)
class Measured:
    """A measured value and its standard deviation."""

    value: float
    std: float


Evidence = Mapping[str, Measured]
"""Measured value of each quantity, by the quantity's name."""


def pooled(several: Iterable[Evidence]) -> dict[str, Measured]:
    """Return the weighted mean of every quantity over the records that contain it.

    Scatter between records that exceeds their stated errors widens the error.
    """
    together: dict[str, list[Measured]] = {}
    for evidence in several:
        for name, measured in evidence.items():
            if np.isfinite(measured.value) and measured.std > 0.0:
                together.setdefault(name, []).append(measured)
    return {
        name: Measured(*weighted([m.value for m in estimates], [m.std for m in estimates]))
        for name, estimates in together.items()
    }


AS_STATED = "as stated"
ANY = "any other scale"
_DECADES = 4.0
"""Decades of scale, from 0.01 to 100 with either sign, over which "any other scale" is uniform. The ratio of
any two units in use lies within this range."""
EXCLUDED = 0.01
"""Largest posterior probability of an excluded hypothesis: the usual level of 99 %."""
_RESOLVED_SIGMAS = 3.0
"""Least distance of a measured scale from zero, in standard deviations, for a significant scale. A smaller
scale may be noise, which any unit of small readings explains."""


@dataclass(frozen=True, slots=True)
class Weighed:
    """Posterior over the hypotheses on one scale."""

    best: str
    """Name of the likeliest hypothesis."""
    factor: float
    """Factor of the likeliest hypothesis, or the measured scale for ``ANY``."""
    stated_probability: float
    """Posterior probability that the instrument reads as stated (``AS_STATED``)."""
    resolved: bool
    """Whether the reading follows the motion beyond its errors."""

    @property
    def contradicts(self) -> bool:
        """Whether the measured scale excludes the stated one."""
        return self.resolved and self.stated_probability < EXCLUDED


def weigh(measured: Measured, factors: Mapping[str, float], width: float, stated: float = 1.0) -> Weighed:
    """Return the posterior probabilities of the hypotheses about a scale.

    Parameters
    ----------
    factors
        Factor of each hypothesis relative to the stated reading, without ``AS_STATED``.
    width
        Standard deviation of an instrument's scale, as a share.
    stated
        Mean scale of an instrument that reads as stated.
    """
    candidates = {AS_STATED: 1.0, **factors}
    likelihood = {
        name: _normal(
            measured.value - factor * stated, hypot(width * abs(factor * stated), measured.std)
        )
        for name, factor in candidates.items()
    }  # fmt: skip
    size = max(abs(measured.value), measured.std)
    likelihood[ANY] = 1.0 / (2.0 * _DECADES * log(10.0) * size)
    total = sum(likelihood.values())
    best = max(likelihood, key=lambda name: likelihood[name])
    factor = candidates.get(best, measured.value)
    resolved = abs(measured.value) >= _RESOLVED_SIGMAS * measured.std
    return Weighed(best, factor, likelihood[AS_STATED] / total, resolved)


def _normal(distance: float, std: float) -> float:
    return exp(-0.5 * (distance / std) ** 2) / (std * sqrt(2.0 * pi))
