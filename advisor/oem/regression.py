"""Linear regression of all manoeuvres together, with constants for each manoeuvre."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from advisor.process.arrays import FloatArray

_INDIFFERENT = 1e-6
"""Relative singular value below which a direction of the common coefficients is ignored. Where the motion is
excited, the relative singular value is at least 1e-3."""


class Equations(NamedTuple):
    """Regression equations of one manoeuvre."""

    common: FloatArray
    """Shape (n, k): columns whose coefficients all manoeuvres share."""
    side: FloatArray
    """Shape (n,): left side of the equations."""
    own: FloatArray
    """Shape (n, l): columns whose coefficients belong to the manoeuvre."""


def regressed(parts: Sequence[Equations]) -> tuple[FloatArray, list[FloatArray]]:
    """Return the common coefficients (k,), and the own coefficients (l,) of each manoeuvre.

    Each manoeuvre's own columns are projected out of its common columns and of its right side. The
    coefficients are always finite; without information the solution has least norm.
    """
    gains = [np.linalg.pinv(part.own) for part in parts]
    rest = [
        (part.common - part.own @ (gain @ part.common), part.side - part.own @ (gain @ part.side))
        for part, gain in zip(parts, gains, strict=True)
    ]
    stacked, sides = (np.concatenate(columns) for columns in zip(*rest, strict=True))
    size = np.maximum(np.linalg.norm(stacked, axis=0), 1e-12)
    slope = np.linalg.lstsq(stacked / size, sides, rcond=_INDIFFERENT)[0] / size
    return slope, [gain @ (part.side - part.common @ slope) for part, gain in zip(parts, gains, strict=True)]
