"""Defects between command and surface: rate limit, backlash, dead band, friction."""

import math

_TRIMMED_S = 2.0
"""Time for which a command must be constant to count as a trim, s. Few steps of a test input last so long."""


class RateLimit:
    """A surface with a limited rate."""

    def __init__(self, rate_rad_s: float) -> None:
        self.rate = rate_rad_s
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the surface to rest at ``value``, rad."""
        self._output = value

    def step(self, value: float, dt: float) -> float:
        """Return the surface deflection after ``dt`` s, rad."""
        most = self.rate * dt
        self._output += min(max(value - self._output, -most), most)
        return self._output


class Backlash:
    """Play in the linkage. The surface moves only while one flank pushes."""

    def __init__(self, half_width_rad: float) -> None:
        self.half_width = half_width_rad
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the linkage to the middle of its play."""
        self._output = value

    def step(self, value: float, dt: float) -> float:
        """Return the surface deflection after ``dt`` s, rad."""
        self._output = min(max(self._output, value - self.half_width), value + self.half_width)
        return self._output


class Deadband:
    """Dead band. Commands near neutral move nothing, and larger commands are reduced by the band's
    half-width.

    Parameters
    ----------
    half_width_rad, neutral_rad
        Half of the band's width, and its centre.
    above_trim_rad
        Offset of the band from the resting command, for a band that moves with the trim.
    """

    def __init__(
        self, half_width_rad: float, neutral_rad: float, above_trim_rad: float | None = None
    ) -> None:
        self.half_width = half_width_rad
        self.neutral = neutral_rad
        self._above_trim = above_trim_rad
        self._last, self._resting_s = math.nan, 0.0

    def reset(self, value: float) -> None:
        """Do nothing, because a dead band has no memory."""

    def step(self, value: float, dt: float) -> float:
        """Return the surface deflection for the command ``value``, rad."""
        self._resting_s = self._resting_s + dt if value == self._last else 0.0
        self._last = value
        if self._above_trim is not None and self._resting_s > _TRIMMED_S:
            self.neutral = value + self._above_trim
        off = value - self.neutral
        beyond = max(abs(off) - self.half_width, 0.0)
        return self.neutral + (beyond if off > 0 else -beyond)


class Stiction:
    """Dry friction. The surface sticks until the error exceeds the friction, then jumps to the command."""

    def __init__(self, breakaway_rad: float) -> None:
        self.breakaway = breakaway_rad
        self.reset(0.0)

    def reset(self, value: float) -> None:
        """Set the surface to stick at ``value``, rad."""
        self._output = value

    def step(self, value: float, dt: float) -> float:
        """Return the surface deflection after ``dt`` s, rad."""
        if abs(value - self._output) > self.breakaway:
            self._output = value
        return self._output
