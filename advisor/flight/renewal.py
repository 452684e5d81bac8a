"""New values, or old ones sent again under fresh stamps."""

import numpy as np

from advisor.flight.messages import FloatArray

_MOSTLY_NEW = 0.7
"""Share of new values from which on nothing is sent twice."""
_STUCK_S = 0.5
"""No channel that is worth anything is renewed less often."""


def renewed(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Only samples that bring a new value, when a channel repeats old ones; ``t`` and ``y`` of shape (n,).

    What rests for longer was not sent again: the sensor is stuck, or nothing moves.
    """
    new = np.concatenate(([True], np.diff(y) != 0.0))
    if np.mean(new) >= _MOSTLY_NEW or np.max(np.diff(t[new], append=t[-1:])) > _STUCK_S:
        return t, y
    return t[new], y[new]
