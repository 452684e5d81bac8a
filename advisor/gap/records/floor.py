"""Noise floor of a residual.

Differences of raw samples show the white noise of an instrument (``Flights.white``), unless the record was
filtered before storage. A coloured residual has a smaller effective sample size.
"""

import numpy as np

from advisor.gap.records.flights import PreparedManeuvers
from advisor.process.arrays import FloatArray

TOLERANCE = 0.02
"""Prior: noise that is assumed in a record filtered before storage, as a share of the channel's peak."""
SMOOTH = 1e-3
"""White noise over the channel's peak below which a channel was filtered, because no instrument is so
quiet."""
_RAW = 1e-2
"""White noise over the channel's peak above which a channel still shows its instrument's noise."""


def prefiltered(flights: PreparedManeuvers) -> dict[str, bool]:
    """Return for each channel whether it was filtered or is smoother than an instrument's white noise."""
    # An angle of attack that an autopilot computes is smooth by nature, and says nothing of other channels.
    filtered = flights.alpha_is_smoothed and not flights.alpha_is_derived
    smooth = flights.white < (_RAW if filtered else SMOOTH) * flights.peaks
    smooth |= flights.alpha_is_smoothed & (np.array(flights.channels) == "alpha")
    return dict(zip(flights.channels, smooth.tolist(), strict=True))


def stated_floor(flights: PreparedManeuvers) -> FloatArray:
    """Return the least noise of each channel, shape (channels,): 2 % of the peak if filtered before
    storage."""
    smooth = np.array(list(prefiltered(flights).values()))
    return np.maximum(flights.white, np.where(smooth, TOLERANCE * flights.peaks, 0.0))


def tolerance_of(flights: PreparedManeuvers) -> FloatArray:
    """Return the assumed noise of channels filtered before storage, 0 for other channels, shape
    (channels,)."""
    return np.where(list(prefiltered(flights).values()), stated_floor(flights), 0.0)


def effective_sample_size(residual: FloatArray) -> float:
    """Return the effective sample size N/(1 + 2 Σ ρ_k) of a residual, summed up to the first zero of ρ."""
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
