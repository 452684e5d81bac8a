"""The present power-on as one picture: channels over time, and the flight modes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import isfinite

from advisor.flight.signals.extremes import Course

_EVERY_S = 1.0
"""Vehicle time between two pictures, s. A picture of many minutes does not change sooner."""


@dataclass(frozen=True, slots=True, eq=False)
class WholeFlight:
    """Channels and modes of the power-on being heard."""

    courses: Mapping[str, Course] = field(default_factory=dict)
    modes: tuple[tuple[float, str], ...] = ()
    """Vehicle time at which each mode began, s since boot, and its name."""


class WholeFlights:
    """Keeps the picture of the present power-on, and renews it from time to time."""

    def __init__(self) -> None:
        self._newest = WholeFlight()
        self._at: tuple[tuple[int, int], float] | None = None
        self._power_on = (0, 0)
        self._modes: tuple[tuple[float, str], ...] = ()

    def change_mode(self, power_on: tuple[int, int], at_s: float, mode: str) -> None:
        """Take a change of the flight mode at a vehicle time, s; NaN before the clock is heard."""
        if power_on != self._power_on:
            self._power_on, self._modes = power_on, ()
        self._modes = (*self._modes, (at_s if isfinite(at_s) else 0.0, mode))

    def now(
        self, power_on: tuple[int, int], now_s: float, courses: Callable[[], Mapping[str, Course]]
    ) -> WholeFlight:
        """Return the picture; the identical object while it is not renewed."""
        if self._at is not None and self._at[0] == power_on and now_s < self._at[1] + _EVERY_S:
            return self._newest
        if isfinite(now_s):
            self._at = power_on, now_s
            modes = self._modes if power_on == self._power_on else ()
            self._newest = WholeFlight(courses(), modes)
        return self._newest
