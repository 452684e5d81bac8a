"""How much of what is left is only noise.

Beside the instrument's white noise, which differences of the raw samples show (``Flights.white``): whether a
record has been filtered before it was stored (then those differences say nothing), and how many
independent samples a coloured residual is worth.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.records.flights import Flights

TOLERANCE = 0.02
"""Of the channel's peak: what is called noise in a record that was filtered before it was stored."""
STATED_FLOOR_MARGIN = 2.5
"""How many times a floor that is stated, not measured, must be exceeded to count."""
_SMOOTH = 1e-3
"""Share of its peak below which a channel has less white noise than any instrument."""
_RAW = 1e-2
"""Share from which on a channel has its instrument's noise, though the angle of attack was filtered."""


def prefiltered(flights: Flights) -> dict[str, bool]:
    """Channels of a record that was filtered, or that are smoother than white noise can be."""
    smooth = flights.white < (_RAW if flights.alpha_is_smoothed else _SMOOTH) * flights.peaks
    smooth |= flights.alpha_is_smoothed & (np.array(flights.channels) == "alpha")
    return dict(zip(flights.channels, smooth.tolist(), strict=True))


def floor_margins(flights: Flights) -> FloatArray:
    """Shape (channels,): how many times its floor a channel must show."""
    return np.where(list(prefiltered(flights).values()), STATED_FLOOR_MARGIN, 1.0)


def stated_floor(flights: Flights) -> FloatArray:
    """Shape (channels,): the least ever called noise; 2 % of peak where the record was filtered before."""
    smooth = np.array(list(prefiltered(flights).values()))
    return np.maximum(flights.white, np.where(smooth, TOLERANCE * flights.peaks, 0.0))


def tolerance_of(flights: Flights) -> FloatArray:
    """Shape (channels,): what is called noise where a channel was filtered before it was recorded, else 0."""
    return np.where(list(prefiltered(flights).values()), stated_floor(flights), 0.0)


def effective_sample_size(residual: FloatArray) -> float:
    """How many independent samples a residual is worth: N/(1 + 2 Σ ρ_k), summed to its first zero."""
    v = residual - np.mean(residual)
    n = len(v)
    power = float(v @ v)
    if n < 8 or power <= 0.0:
        return float(n)
    total = 1.0
    for k in range(1, n // 4):
        rho = float(v[k:] @ v[:-k]) / power
        if rho <= 0.02:
            break
        total += 2.0 * rho
    return n / total
