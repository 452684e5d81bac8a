"""Prior of a manoeuvre's initial state and trim: near steady flight, so that no fit runs away.

A record begins before the first step, in nearly steady flight. Without an angle of attack no other
measurement determines its initial value.
"""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import NUISANCES, REFERENCE

_START_RAD = 0.035
"""Prior: standard deviation of a record's initial angle of attack about the mean before the first step, rad.
Decaying motion or a gust changes the angle of attack by 2 deg."""
_LOAD_FACTOR = 0.3
"""Prior: standard deviation of the load factor in trim about that of level flight: a turn of 30 deg has
0.15."""


def own_mean(flight: PreparedManeuver) -> FloatArray:
    """Return the prior means of a manoeuvre's initial states and trim terms, shape (4,)."""
    mean = dict.fromkeys(NUISANCES, 0.0) | {"Z_trim": flight.level_lift}
    return np.array([mean[name] for name in NUISANCES])


def own_precision(flight: PreparedManeuver) -> FloatArray:
    """Return the inverse prior variances of a manoeuvre's initial states and trim terms, shape (4,).

    The pitch rate is measured, and no physics bounds the moment in trim: their priors are flat.
    """
    lift = _LOAD_FACTOR * GRAVITY_M_S2 / float(flight.trim[REFERENCE])
    known = {"alpha_start": 1.0 / _START_RAD**2, "Z_trim": 1.0 / lift**2}
    return np.array([known.get(name, 0.0) for name in NUISANCES])
