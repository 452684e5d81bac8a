"""Mean offset of an angle of attack, from attitude and climb rate alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.motion import channel_at, gravity_in_plane
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
