"""Axes: ranges and ticks at round numbers, in equal steps or in equal ratios."""

from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np

from advisor.process.arrays import FloatArray

_FINENESS = 8
"""Number of grains in the length of an axis. The ends are rounded to a grain, an eighth of the length."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Axis with rounded ends and the step of its ticks. The ends stay unchanged while new data lie between
    them.
    """

    low: float
    high: float
    step: float

    @property
    def ticks(self) -> list[float]:
        """Multiples of ``step`` from ``low`` to ``high``."""
        first, last = ceil(self.low / self.step - 1e-9), floor(self.high / self.step + 1e-9)
        return [k * self.step for k in range(first, last + 1)]

    @property
    def labels(self) -> list[str]:
        """Texts of the ticks, with as many decimals as the step needs."""
        decimals = max(0, -floor(log10(self.step) + 1e-9))
        return [f"{tick:.{decimals}f}" for tick in self.ticks]


@dataclass(frozen=True, slots=True)
class LogAxis:
    """Logarithmic axis with ticks at 1, 2 and 5 times powers of ten, or at powers of ten alone."""

    low: float
    """Decimal logarithm of the value at the lower end."""
    high: float
    """Decimal logarithm of the value at the upper end."""
    values: tuple[float, ...]
    """Values of the ticks, rising."""

    @property
    def ticks(self) -> list[float]:
        """Decimal logarithms of ``values``."""
        return [log10(value) for value in self.values]

    @property
    def labels(self) -> list[str]:
        """Texts of the values, without an exponent: ``25``, ``2,500``."""
        return [f"{value:,.0f}" if value >= 1.0 else f"{value:g}" for value in self.values]


def log_axis(values: list[FloatArray], most: int) -> LogAxis:
    """Choose the logarithmic axis that holds all positive values, with about ``most`` ticks and at least two.

    Parameters
    ----------
    values : list of ndarray
        Data of any lengths. Values that are not positive and finite are left out; without any value the range
        is 1 to 10.
    most : int
        Wanted number of ticks, at least 2.
    """
    positive = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in values] or [np.empty(0)])
    low, high = (float(positive.min()), float(positive.max())) if len(positive) else (1.0, 10.0)
    bottom, top = _round_up(low / 2.2), _round_up(high * 1.05)
    first, last = floor(log10(bottom) + 1e-9), ceil(log10(top) - 1e-9)
    fine = [m * 10.0**k for k in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    ticks = [value for value in fine if bottom * (1 - 1e-9) <= value <= top * (1 + 1e-9)]
    every = 1
    while len(ticks) > max(most, 2):
        decades = [10.0**k for k in range(first, last + 1) if k % every == 0]
        sparser = [value for value in decades if bottom * (1 - 1e-9) <= value <= top * (1 + 1e-9)]
        if len(sparser) < 2:
            break
        ticks, every = sparser, every + 1
    return LogAxis(log10(bottom), log10(top), tuple(ticks))


def round_axis(values: list[FloatArray], intervals: int) -> Axis:
    """Choose the axis that holds all finite values, with about ``intervals`` steps and at least two ticks.

    Parameters
    ----------
    values : list of ndarray
        Data of any lengths; empty or not finite data give the range 0 to 1.
    intervals : int
        Wanted number of steps of 1, 2 or 5 times a power of ten, at least 1.
    """
    finite = [v[np.isfinite(v)] for v in values]
    finite = [v for v in finite if len(v)]
    low = min((float(v.min()) for v in finite), default=0.0)
    high = max((float(v.max()) for v in finite), default=1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-12):
        margin = max(abs(low) * 0.1, 1e-6)
        low, high = low - margin, high + margin
    grain = _round_up((high - low) / _FINENESS)
    low, high = floor(low / grain + 1e-9) * grain, ceil(high / grain - 1e-9) * grain
    axis = Axis(low, high, _round_up((high - low) / max(intervals, 1)))
    while len(axis.ticks) < 2:
        axis = Axis(low, high, _round_up(axis.step * 0.4))
    return axis


def exact_axis(low: float, high: float, intervals: int) -> Axis:
    """Choose the axis for a range with fixed ends, with about ``intervals`` steps and at least three ticks.

    Parameters
    ----------
    low, high
        Ends of the range; low is below high.
    intervals
        Wanted number of steps of 1, 2 or 5 times a power of ten, at least 1.
    """
    axis = Axis(low, high, _round_up((high - low) / max(intervals, 1)))
    while len(axis.ticks) < 3:
        axis = Axis(low, high, _round_up(axis.step * 0.4))
    return axis


def _round_up(step: float) -> float:
    """Return the smallest number at or above the value that is 1, 2 or 5 times a power of ten."""
    magnitude = 10.0 ** floor(log10(step))
    return next(m * magnitude for m in (1.0, 2.0, 5.0, 10.0) if m * magnitude >= step * (1.0 - 1e-9))
