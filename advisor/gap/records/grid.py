"""The even time grid on which a manoeuvre is simulated."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

STEP_S = 0.005
"""Numerical: step of the grid in s: a hundredth of the fastest short period, and as fine as stamps are
known."""


def smooth(y: FloatArray, seconds: float) -> FloatArray:
    """Return the centred moving average over ``seconds`` of a series on the grid, shape (n,)."""
    width = max(1, round(seconds / STEP_S)) | 1
    padded = np.pad(y, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
