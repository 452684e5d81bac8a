"""Where a channel comes from: an instrument or an estimator; new values, or old ones sent again."""

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray

_ESTIMATED_HZ = 22.0
"""ArduPilot renews its estimate of α 20 times a second at most."""


def is_estimate(m: Maneuver, smoothed: bool) -> bool:
    """Whether α is made from inertial sensors, as it says of itself.

    ArduPilot says so of whatever it sends. What is rough and renewed too fast for its estimator is a vane's.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance != "derived":
        return False
    t, _ = renewed(alpha.t, alpha.y)
    slow = len(t) < _ESTIMATED_HZ * (alpha.t[-1] - alpha.t[0])
    return slow or smoothed or not alpha.source.startswith("AOA_SSA")


def renewed(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Only samples that bring a new value, when a channel repeats old ones under fresh stamps."""
    new = np.concatenate(([True], np.diff(y) != 0.0))
    return (t[new], y[new]) if np.mean(new) < 0.7 else (t, y)
