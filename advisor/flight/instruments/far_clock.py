"""A clock error that looks like a reversed sign.

An oscillation that is late by half a period has the opposite sign. A wrong sign is therefore certain only if
no shift of the stamps explains the signal with the right sign.
"""

from collections.abc import Sequence
from math import log
from typing import NamedTuple

import numpy as np

from advisor.flight.instruments.delayed_fit import LONGEST_DELAY_S
from advisor.flight.instruments.measured import EXCLUDED
from advisor.process.arrays import FloatArray

FARTHEST_S = 3.0
"""Largest clock error in the search, s: half a period of a slow Dutch roll (6 s)."""
_STEP_S = 0.05
"""Distance of the delays in the search, s: a fortieth of the period of a fast Dutch roll."""
CLOCK_STD_S = 0.1
"""Standard deviation of a clock error that is found, s. The side force is not a part of the expected signal,
and shifts the sideslip of a small aircraft by 0.2 s."""


class _Try(NamedTuple):
    """Fit of a signal at one delay."""

    delay_s: float
    factor: float
    unexplained: float
    """Mean square of the residual over that of the signal without its drift."""
    independent: float
    """Number of independent samples of the residual."""


class SignOrClock(NamedTuple):
    """Evidence about a signal with a seemingly wrong sign."""

    is_sign: bool
    """Whether a wrong sign explains the signal, and a clock error is excluded at 99 %."""
    late_s: float
    """Delay at which the right sign explains the signal best, s."""
    is_clock: bool
    """Whether the clock error explains the signal better than a wrong sign."""


def sign_or_clock(
    t: FloatArray, y: FloatArray, grid: FloatArray, shape: FloatArray, sense: float, drift: int
) -> SignOrClock:
    """Compare a wrong sign with a clock error as the cause of a signal.

    Parameters
    ----------
    t, y
        Shape (n,): stamps, s, and values of the signal.
    grid, shape
        Shape (m,): stamps, s, and values of the expected signal, up to a factor.
    sense
        Sign of the factor on every aircraft.
    drift
        Degree of the polynomial in time that is added to the signal.
    """
    delays = np.arange(-FARTHEST_S, FARTHEST_S + _STEP_S / 2.0, _STEP_S)
    tries = [fit for delay in delays.tolist() if (fit := _tried(t, y, grid, shape, delay, drift)) is not None]
    right = [fit for fit in tries if fit.factor * sense > 0.0]
    wrong = [fit for fit in tries if fit.factor * sense < 0.0 and abs(fit.delay_s) <= LONGEST_DELAY_S]
    if not wrong or not right:
        return SignOrClock(bool(wrong), 0.0, bool(right))
    clock, sign = _best(right), _best(wrong)
    nats = 0.5 * min(clock.independent, sign.independent) * log(clock.unexplained / sign.unexplained)
    return SignOrClock(nats > -log(EXCLUDED), clock.delay_s, nats < log(EXCLUDED))


def _best(tries: Sequence[_Try]) -> _Try:
    return min(tries, key=lambda fit: fit.unexplained)


def _tried(
    t: FloatArray, y: FloatArray, grid: FloatArray, shape: FloatArray, delay_s: float, drift: int
) -> _Try | None:
    """Return the fit at one delay; None if the shift leaves less than half of the samples."""
    inside = (t - delay_s >= grid[0]) & (t - delay_s <= grid[-1])
    if np.count_nonzero(inside) < max(len(t) // 2, drift + 4):
        return None
    at, seen = t[inside] - delay_s, y[inside]
    slow = np.vander((at - at.mean()) / max(np.ptp(at), 1e-9), drift + 1)
    moved = np.interp(at, grid, shape)
    columns = np.column_stack([moved, slow])
    fitted = np.linalg.lstsq(columns, seen, rcond=None)[0]
    residual = seen - columns @ fitted
    whole = seen - slow @ np.linalg.lstsq(slow, seen, rcond=None)[0]
    power = float(np.mean(whole**2))
    if not power > 0.0:
        return None
    noise = residual - residual.mean()
    keep = min(max(float(noise[1:] @ noise[:-1]) / max(float(noise @ noise), 1e-300), 0.0), 0.99)
    share = max(float(np.mean(residual**2)) / power, 1e-9)
    return _Try(delay_s, float(fitted[0]), share, len(seen) * (1.0 - keep) / (1.0 + keep))
