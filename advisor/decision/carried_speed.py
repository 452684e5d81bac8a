"""Whether the accelerometers carry the air speed of a manoeuvre across a gap of its sensor."""

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.airspeed import LARGEST_DISAGREEMENT, LONGEST_LAG_S, airspeed
from advisor.words.quantiles import NORMAL_95


def is_speed_carried(maneuver: Maneuver) -> bool:
    """Return whether the air speed is the integral of the accelerometers, with a small error everywhere.

    The sensor gives level and drift of the integral. Their error grows with the distance from the sensor's
    samples. The sensor is filtered: its error is renewed once in ``LONGEST_LAG_S``, not with each sample.
    """
    found = airspeed(maneuver.channels)
    if found is None or not found.smooth:
        return False
    sensor = maneuver.channels["airspeed"]
    sampled = sensor.t - found.lag_s
    std = float(np.std(sensor.y - found.signal.at(sampled)))
    independent = max(1.0, float(np.ptp(sampled)) / LONGEST_LAG_S)
    ends = found.signal.t[[0, -1]] - float(np.mean(sampled))
    largest = std * np.sqrt((1.0 + np.max(ends**2) / float(np.var(sampled))) / independent)
    return bool(NORMAL_95 * largest <= LARGEST_DISAGREEMENT * float(np.mean(sensor.y)))
