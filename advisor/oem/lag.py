"""Compiled first-order lag of a servo, and its derivatives by delay and lag."""

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel()
def lag_changes(
    step: FloatArray, rate: FloatArray, jump: FloatArray, lag: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the derivatives of a lagged surface by the delay, after and before each stamp, and by the lag.

    Parameters
    ----------
    rate : (n,) of the command in each step; jump : (n + 1,) of the command at each stamp.
    """
    begin, end, slower = np.zeros(len(jump)), np.zeros(len(jump)), np.zeros(len(jump))
    for i in range(len(step)):
        begin[i] = end[i] - jump[i] / lag
        kept = np.exp(-step[i] / lag)
        forgotten = (begin[i] + rate[i]) * kept
        end[i + 1] = forgotten - rate[i]
        slower[i + 1] = slower[i] * kept - rate[i] * (1.0 - kept) + forgotten * step[i] / lag
    begin[-1] = end[-1]
    return begin, end, slower


@kernel()
def lagged(
    step: FloatArray, start: FloatArray, arrival: FloatArray, lag: float, initial: float
) -> FloatArray:
    """Return the first-order lag of a command that moves linearly from ``start`` to ``arrival`` in each
    ``step``."""
    surface = np.empty(len(step) + 1)
    surface[0] = initial
    for i in range(len(step)):
        trailing = lag * (arrival[i] - start[i]) / step[i]
        surface[i + 1] = arrival[i] - trailing + (surface[i] - start[i] + trailing) * np.exp(-step[i] / lag)
    return surface
