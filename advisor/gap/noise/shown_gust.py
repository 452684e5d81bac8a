"""Largest gust that the instruments of a flight show, without aerodynamics.

A vane turns with a gust, and the motion of the aircraft follows later. In still air α̇ equals the pitch rate
minus the rate of the flight path angle. The vane reading beyond the integral of that difference is the gust
angle w/V plus instrument errors.
"""

import numpy as np

from advisor.flight.signals.motion import integrated, path_turning
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.simulator.layout import A_X, BANK, SPEED
from advisor.oem.turbulence import LARGEST_GUST_RAD
from advisor.process.arrays import FloatArray

_NEEDED = ("alpha", "q", "a_z", "theta")


def largest_gust(flights: PreparedManeuvers, z_alpha: float) -> float:
    """Return the largest gust angle that the flight shows, rad, from its vane and motion, and from its lift.

    A gust moves the vane, and the lift follows the gust. A fit with a wrong model can require a gust of any
    size.

    Parameters
    ----------
    z_alpha
        Lift derivative Z_α, 1/s, of a model that may be wrong.
    """
    shown = [LARGEST_GUST_RAD]
    if "alpha" in flights.channels and not flights.alpha_is_derived:
        shown.append(max(float(np.ptp(_beyond_motion(flight))) for flight in flights.flights))
    if "a_z" in flights.channels and z_alpha != 0.0:
        forces = (float(np.ptp(f.outputs["a_z"].y) / np.mean(f.slow[SPEED])) for f in flights.flights)
        shown.append(max(forces) / abs(z_alpha))
    return min(shown)


def _beyond_motion(flight: PreparedManeuver) -> FloatArray:
    """Return α minus that of the motion, rad, shape (n,), without the straight line of offsets."""
    t, alpha = flight.outputs["alpha"].t, flight.outputs["alpha"].y
    if not all(name in flight.outputs for name in _NEEDED):
        return alpha
    q, a_z, theta = (flight.outputs[n].at(t) for n in _NEEDED[1:])
    middles = (np.arange(flight.n) + 0.5) * flight.h
    a_x, bank, speed = (np.interp(t, middles, flight.slow[row]) for row in (A_X, BANK, SPEED))
    beyond = alpha - integrated(t, q + path_turning(a_x, a_z, theta, alpha, bank) / speed)
    line = np.column_stack([np.ones_like(t), t])
    return np.asarray(beyond - line @ np.linalg.lstsq(line, beyond)[0])
