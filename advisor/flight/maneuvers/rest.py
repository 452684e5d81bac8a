"""Rest of the elevator, relative to the movement that the rest ends.

A stick is never perfectly still, so that rest is a question of scale. A hand that shakes by a tenth of a
large input is at rest after that input. The shaking would be no rest after a smaller input.
"""

import numpy as np

from advisor.flight.signals.messages import FloatArray

SMALLEST_RAD = float(np.radians(0.15))
"""Least amplitude of a movement, rad: somewhat more than two steps of an output of 1 us at 0.06 deg a
microsecond."""
STILL_SPREAD = 0.15
"""Largest standard deviation of a rest, as a share of the movement's amplitude. A shaking stick has 0.1; a
sine with that amplitude has 0.7."""
_STILL_SHIFT = 0.12
"""Largest difference between the means over the thirds of a rest, as a share of the amplitude."""


def median(x: FloatArray) -> float:
    """Return the median, faster than NumPy's on few numbers, without a test for NaN."""
    middle = np.sort(x)[(len(x) - 1) // 2 : len(x) // 2 + 1]
    return float(middle.sum() / len(middle))


def is_still(u: FloatArray, amplitude: float) -> bool:
    """Return whether the elevator rests over a window, relative to a movement of this amplitude.

    Parameters
    ----------
    u
        Shape (n,): elevator in the window, rad.
    amplitude
        Largest deviation of the movement, rad.

    Returns
    -------
    bool
        True where both the spread and the drift of the window are small. White noise may have a
        spread of ``STILL_SPREAD``. The means over thirds show a drift in one direction.
    """
    if len(u) < 3 or float(u.std()) > STILL_SPREAD * amplitude:
        return False
    third = len(u) // 3
    means = (float(u[:third].mean()), float(u[third:-third].mean()), float(u[-third:].mean()))
    # Second differences separate white noise from a moving level.
    bent = u[2:] - 2.0 * u[1:-1] + u[:-2]
    noise = 2.0 * float(np.sqrt((bent * bent).mean() / (6.0 * third)))
    return max(means) - min(means) <= _STILL_SHIFT * amplitude + min(noise, STILL_SPREAD * amplitude)


def without_spikes(u: FloatArray) -> FloatArray:
    """Return the median of three neighbours, because a single sample is no movement."""
    if len(u) < 3:
        return u
    low, high = np.minimum(u[:-2], u[1:-1]), np.maximum(u[:-2], u[1:-1])
    return np.concatenate(([u[0]], np.maximum(low, np.minimum(high, u[2:])), [u[-1]]))
