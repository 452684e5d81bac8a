"""Removal or correction of samples that no aircraft can have flown, with a sentence on each repair.

A single sample may deviate from the motion by more than the range of all other samples. Such an outlier is a
fault of a memory card, a radio or a driver. An angle between 0 and 360 deg is converted to an angle about
zero.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.flight.signals.robust import robust_std
from advisor.process.arrays import FloatArray
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
"""Channels of continuous motion, with their names for people."""
_NOISE = 10.0
"""Least deviation of an outlier from its neighbours, in standard deviations of all such deviations."""
_OTHERS = (2.0, 98.0)
"""Percentiles that bound the range of the other samples."""
_MOST = 0.02
"""Largest share of outliers that counts as a fault of single samples, not of the channel. With more outliers,
the percentiles in ``_OTHERS`` would include them."""
_FEWEST = 20
"""Least number of samples from which a range is determined."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """A channel after its repair."""

    channel: Channel
    said: tuple[str, ...] = ()
    """Sentences about the repair; empty for an unchanged channel."""


def repaired(channel: Channel) -> Repaired:
    """Return a manoeuvre's channel with samples removed or corrected that no aircraft can have flown."""
    if channel.name not in _WATCHED or len(channel) < _FEWEST:
        return Repaired(channel)
    mended, said = channel, []
    if channel.name == "alpha" and np.any(channel.y > pi):
        mended = replace(channel, y=np.where(channel.y > pi, channel.y - 2.0 * pi, channel.y))
        said.append(
            "The angle of attack is sent from 0 to 360 deg: values above 180 deg are read as negative."
        )
    if channel.name == "airspeed" and (dead := _dropped_out(mended)).any():
        at = f"{clock(float(mended.t[dead][0]))} to {clock(float(mended.t[dead][-1]))}"
        said.append(f"The air speed drops out from {at} and is bridged.")
        mended = replace(mended, t=mended.t[~dead], y=mended.y[~dead])
    wild = _wild(mended.y)
    n = int(np.count_nonzero(wild))
    if 0 < n <= _MOST * len(wild):
        mended = replace(mended, t=mended.t[~wild], y=mended.y[~wild])
        are = "samples are" if n > 1 else "sample is"
        said.append(f"{n} of {len(wild)} {_WATCHED[channel.name]} {are} wild and left out.")
    return Repaired(mended, tuple(said))


def _dropped_out(airspeed: Channel) -> NDArray[np.bool_]:
    """Return whether each air speed is below any flight speed, in a manoeuvre in flight."""
    dead = airspeed.y <= SLOWEST_FLIGHT_M_S
    # The aircraft loses half of its speed at most, so that it would not have stopped in the air.
    flies = float(np.median(airspeed.y)) > 2.0 * SLOWEST_FLIGHT_M_S
    return np.asarray(dead & flies)


def _wild(y: FloatArray) -> NDArray[np.bool_]:
    """Return whether each sample deviates from its neighbours by more than the others' range."""
    neighbours = 0.5 * (y[:-2] + y[2:])
    away = np.abs(y[1:-1] - neighbours)
    # A neighbour of a wild sample leaves the mean of its own neighbours by half as much.
    nearer = np.minimum(np.abs(y[1:-1] - y[:-2]), np.abs(y[1:-1] - y[2:]))
    low, high = np.percentile(y, _OTHERS)
    wild = np.zeros(len(y), dtype=bool)
    if not np.any(nearer > high - low):
        return wild
    wild[1:-1] = (nearer > high - low) & (away > _NOISE * robust_std(y[1:-1] - neighbours)) & (high > low)
    return wild
