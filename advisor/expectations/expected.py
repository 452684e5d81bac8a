"""Expectations of a flight, as a file states them. Units are SI; angles are rad."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from advisor.model.mil_f_8785c import Category
from advisor.words.axes import AxisName

Origin = Literal["number", "model", "log"]
"""Source of an expected value: the expectations file, the aircraft file's model, or another log."""
SECTIONS = (
    "log", "accepted", "complete", "derivatives", "modes", "levels", "gap", "longest_pause_s", "alarms"
)  # fmt: skip
"""Keys of an expectations file."""
MODES: Mapping[str, str] = MappingProxyType(
    {
        "short_period_omega": "rad/s", "short_period_zeta": "", "dutch_roll_omega": "rad/s",
        "dutch_roll_zeta": "", "roll_time_constant": "s", "spiral_pole": "1/s",
    }
)  # fmt: skip
"""Unit of each mode's number, by its key in the section ``modes``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Near:
    """Expected value of a derivative or of a mode, with its tolerance. At least one of the tolerances is
    given."""

    origin: Origin = "number"
    value: float | None = None
    """Expected value, SI; None where another file states the value."""
    within: float | None = None
    """Largest allowed difference from the expected value, SI."""
    within_percent: float | None = None
    """Largest allowed difference from the expected value, % of the expected value."""
    known_to: float | None = None
    """Largest allowed half-width of the 95 % interval, SI."""

    def tolerance(self, value: float) -> float | None:
        """Return the largest allowed difference from an expected value, SI; None without a tolerance.

        Where both tolerances are given, the larger one counts.
        """
        share = None if self.within_percent is None else abs(value) * self.within_percent / 100.0
        allowed = [limit for limit in (self.within, share) if limit is not None]
        return max(allowed) if allowed else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectations:
    """Expectations of one flight. An empty section expects nothing."""

    log: Path | None = None
    """Log whose estimates are the expected values of ``of: log``."""
    accepted: Mapping[AxisName, int] = field(default_factory=dict)
    """Least number of accepted manoeuvres, by axis."""
    complete: Mapping[AxisName, int] = field(default_factory=dict)
    """Number of the manoeuvre by which the flight test is complete, by axis."""
    derivatives: Mapping[str, Near] = field(default_factory=dict)
    modes: Mapping[str, Near] = field(default_factory=dict)
    """Expected modes by the keys of ``MODES``."""
    levels: Mapping[AxisName, Mapping[Category, int]] = field(default_factory=dict)
    """Worst allowed level of MIL-F-8785C, by axis and category of flight phases."""
    gap: Mapping[AxisName, float] = field(default_factory=dict)
    """Largest allowed gap of the simulator as given, by axis."""
    longest_pause_s: Mapping[str, float] = field(default_factory=dict)
    """Longest allowed pause between two samples, s, by channel."""
    alarms: int | None = None
    """Largest allowed number of alarms."""

    @property
    def asks_of_log(self) -> bool:
        """Whether an expected value comes from another log."""
        return any(near.origin == "log" for near in (*self.derivatives.values(), *self.modes.values()))
