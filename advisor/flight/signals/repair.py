"""Samples of a manoeuvre that no aircraft can have flown: left out or put right, and said.

A single sample may leave the motion by more than the whole range of the other samples. Such a value is a
fault of a memory card, a radio or a driver. An angle counted from 0 to 360 deg is put right.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel
from advisor.flight.signals.robust import robust_std
from advisor.words.vehicle_time import clock

_WATCHED = {
    "q": "pitch rate",
    "p": "roll rate",
    "r": "yaw rate",
    "theta": "pitch angle",
    "bank": "bank angle",
    "a_x": "axial acceleration",
    "a_z": "normal acceleration",
    "alpha": "angle of attack",
    "airspeed": "air speed",
    "climb_rate": "climb rate",
}
"""Channels of a motion that is continuous, and their names for people."""
_NOISE = 10.0
"""Least departure of a wild sample from its neighbours, in standard deviations of all such departures."""
_OTHERS = (2.0, 98.0)
"""Percentiles between which lies the range of the other samples."""
_MOST = 0.02
"""Largest share of wild samples that is a fault of single samples, not of the channel. With more of them, the
percentiles above would not be those of the other samples."""
_FEWEST = 20
"""Fewest samples from which a range is taken."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """A channel after its repair."""

    channel: Channel
    said: tuple[str, ...] = ()
    """Sentences on the repair; empty for a channel that stays as it is."""


def repaired(channel: Channel) -> Repaired:
    """Return a channel of a manoeuvre without samples that no aircraft can have flown."""
    if channel.name not in _WATCHED or len(channel) < _FEWEST:
        return Repaired(channel)
    found, said = channel, []
    if channel.name == "alpha" and np.any(channel.y > pi):
        found = replace(channel, y=np.where(channel.y > pi, channel.y - 2.0 * pi, channel.y))
        said.append("The angle of attack is counted from 0 to 360 deg: above 180 deg it counts as negative.")
    if channel.name == "airspeed" and (dead := _dropped_out(found)).any():
        at = f"{clock(float(found.t[dead][0]))} to {clock(float(found.t[dead][-1]))}"
        said.append(f"The air speed drops out from {at} and is bridged.")
        found = replace(found, t=found.t[~dead], y=found.y[~dead])
    wild = _wild(found.y)
    n = int(np.count_nonzero(wild))
    if 0 < n <= _MOST * len(wild):
        found = replace(found, t=found.t[~wild], y=found.y[~wild])
        are = "samples are" if n > 1 else "sample is"
        said.append(f"{n} of {len(wild)} {_WATCHED[channel.name]} {are} wild and left out.")
    return Repaired(found, tuple(said))


def _dropped_out(airspeed: Channel) -> NDArray[np.bool_]:
    """Return whether each air speed is one at which nothing flies, in a manoeuvre that is flown."""
    dead = airspeed.y <= SLOWEST_FLIGHT_M_S
    # The aircraft loses half of its speed at most, so that it would not have stopped in the air.
    flies = float(np.median(airspeed.y)) > 2.0 * SLOWEST_FLIGHT_M_S
    return np.asarray(dead & flies)


def _wild(y: FloatArray) -> NDArray[np.bool_]:
    """Return whether each single sample leaves its neighbours by more than the other samples' range."""
    neighbours = 0.5 * (y[:-2] + y[2:])
    away = np.abs(y[1:-1] - neighbours)
    # A neighbour of a wild sample leaves the mean of its own neighbours by half as much.
    nearer = np.minimum(np.abs(y[1:-1] - y[:-2]), np.abs(y[1:-1] - y[2:]))
    low, high = np.percentile(y, _OTHERS)
    wild = np.zeros(len(y), dtype=bool)
    wild[1:-1] = (nearer > high - low) & (away > _NOISE * robust_std(y[1:-1] - neighbours)) & (high > low)
    return wild
