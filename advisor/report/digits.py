"""Significant digits: two of the interval, and a real minus sign."""

from math import floor, isfinite, log10


def decimals_for(spread: float) -> int:
    """Return the number of decimals that show two significant digits of ``spread``, between 0 and 6."""
    if not (isfinite(spread) and spread > 0.0):
        return 3
    return min(max(1 - floor(log10(spread)), 0), 6)


def signed(value: float, decimals: int) -> str:
    """Return a number with a real minus sign, never "-0"."""
    if not isfinite(value):
        return "-"
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def with_half(value: float, half: float) -> str:
    """Return a number with half its 95 % interval: ``−48.3 ± 2.1``."""
    decimals = decimals_for(half)
    return f"{signed(value, decimals)} ± {signed(half, decimals)}"
