"""The air speed of a manoeuvre: a jump within one sample, and a gap that the accelerometers fill."""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.steady_speed import speed_before
from advisor.oem.airspeed import LARGEST_DISAGREEMENT, LONGEST_LAG_S, airspeed
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95
from advisor.words.vehicle_time import clock

FASTEST_CHANGE_M_S2 = 2.0 * GRAVITY_M_S2
"""Largest rate of change of the air speed in flight, m/s². The value is gravity along the path, and a drag as
large as the weight.
"""
_SIDE = 3
"""Number of samples on each side of a jump, whose medians are compared. One wild sample is no jump."""


def leaping_speed(maneuver: Maneuver, limit: float) -> list[Reason]:
    """Return a reason if the air speed jumps within one sample by more than it may change in the manoeuvre.

    Parameters
    ----------
    limit
        Largest change of the air speed in a manoeuvre, %.
    """
    channel = maneuver.channels.get("airspeed")
    if channel is None or len(channel) < 2 * _SIDE or not np.median(channel.y) > 0.0:
        return []
    level = np.median(np.lib.stride_tricks.sliding_window_view(channel.y, _SIDE), axis=1)
    jump = np.abs(level[_SIDE:] - level[:-_SIDE])
    middle_s = channel.t[1:-1]
    by_flying = FASTEST_CHANGE_M_S2 * (middle_s[_SIDE:] - middle_s[:-_SIDE])
    percent = np.where(jump > by_flying, 100.0 * jump / speed_before(channel, maneuver.span), 0.0)
    k = int(np.argmax(percent))
    if not percent[k] > limit:
        return []
    before, after = distinct_texts(float(level[k]), float(level[k + _SIDE]), 1)
    at = clock(float(channel.t[k + _SIDE]))
    text = (
        f"air speed jumps from {before} to {after} m/s within one sample at {at}, "
        f"by {percent[k]:.0f} % (limit {limit:.0f}); check which air speed sensor flew, and its tube"
    )
    return [Reason("airspeed_jump", text, float(percent[k]), limit, by_instrument=True)]


def is_speed_carried(maneuver: Maneuver) -> bool:
    """Return whether the integral of the accelerometers gives the air speed with a small error throughout.

    The sensor gives level and drift of the integral. Their error grows with the distance from the sensor's
    samples. The sensor is filtered: its error is renewed once in ``LONGEST_LAG_S``, not with each sample.
    """
    integrated = airspeed(maneuver.channels)
    if integrated is None or not integrated.smooth:
        return False
    sensor = maneuver.channels["airspeed"]
    sampled = sensor.t - integrated.lag_s
    std = float(np.std(sensor.y - integrated.signal.at(sampled)))
    independent = max(1.0, float(np.ptp(sampled)) / LONGEST_LAG_S)
    ends = integrated.signal.t[[0, -1]] - float(np.mean(sampled))
    largest = std * np.sqrt((1.0 + np.max(ends**2) / float(np.var(sampled))) / independent)
    return bool(NORMAL_95 * largest <= LARGEST_DISAGREEMENT * float(np.mean(sensor.y)))
