"""How much of what is left is only noise.

Three answers, each for its purpose: the white noise of the instrument, from differences of the raw
samples; whether a record has been filtered before it was stored (then those differences say nothing);
and how many independent samples a coloured residual is worth.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.data import Flights
from advisor.gap.smoothness import white_part

TOLERANCE = 0.02
"""Of the channel's peak: what is called noise in a record that was filtered before it was stored."""


def white_noise(flights: Flights) -> dict[str, float]:
    """Standard deviation of the white part of every channel, robust against edges of the motion."""
    return {c: white_part([f.outputs[c].y for f in flights.flights]) for c in flights.channels}


def prefiltered(flights: Flights) -> dict[str, bool]:
    """Channels of a record that was filtered, or that are smoother than white noise can be."""
    white = white_noise(flights)
    return {c: flights.alpha_is_smoothed or white[c] < 1e-3 * peak_of(flights, c) for c in flights.channels}


def peak_of(flights: Flights, channel: str) -> float:
    """Median over manoeuvres of the largest departure from the starting value."""
    return float(
        np.median([np.max(np.abs(y - _start(y))) for y in (f.outputs[channel].y for f in flights.flights)])
    )


def _start(y: FloatArray) -> float:
    return float(np.median(y[: max(5, len(y) // 50)]))


def stated_floor(flights: Flights) -> FloatArray:
    """Shape (channels,): the least ever called noise; 2 % of peak where the record was filtered before."""
    white, smooth = white_noise(flights), prefiltered(flights)
    tolerated = [TOLERANCE * peak_of(flights, c) if smooth[c] else 0.0 for c in flights.channels]
    return np.maximum([white[c] for c in flights.channels], tolerated)


def independent_samples(left: FloatArray) -> float:
    """How many independent samples a residual is worth: N/(1 + 2 Σ ρ_k), summed to its first zero."""
    v = left - np.mean(left)
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
