"""Expectations of a flight, as a file states them, and the modes of the file's model. Units are SI."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Literal

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.mil_f_8785c import Category
from advisor.model.short_period import ShortPeriod
from advisor.report.qualities import OPTIONAL
from advisor.words.axes import AxisName

_OF_PITCH = ("Z_alpha", "M_alpha", "M_q")
"""Derivatives without which a model has no short period. A Z_q that the file does not state is zero."""


def lacking(model: Mapping[str, float], mode: str) -> tuple[str, ...]:
    """Return the derivatives that a model lacks for a mode; empty for a sufficient model."""
    states_only = [name for name in SIDE_PARAMETERS if "delta" not in name and name not in OPTIONAL]
    needed = _OF_PITCH if mode.startswith("short_period") else states_only
    return tuple(name for name in needed if name not in model)


def mode_of(model: Mapping[str, float], mode: str, trim: Trim | None) -> float | None:
    """Return a mode of a sufficient model, SI; None for a mode that the model does not have.

    Parameters
    ----------
    model
        Derivatives by name, at the reference air speed.
    mode
        Key of ``MODES``.
    trim
        Steady flight of the lateral manoeuvres; None if none was flown.
    """
    if mode.startswith("short_period"):
        short = ShortPeriod.from_mapping(model)
        omega = short.natural_frequency
        number = omega if mode.endswith("omega") else -float(np.trace(short.a)) / (2.0 * omega)
        return number if np.isfinite(number) else None
    if trim is None:
        return None
    theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
    modes = modes_of(state_matrix(theta, trim))
    if mode == "spiral_pole":
        return modes.spiral
    if mode == "roll_time_constant":
        return -1.0 / modes.roll if modes.roll else None
    if modes.dutch_roll is None:
        return None
    omega = abs(modes.dutch_roll)
    return omega if mode == "dutch_roll_omega" else -modes.dutch_roll.real / omega


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
