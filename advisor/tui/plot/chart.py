"""What a plot shows: series with units, levels, and a sentence for when there is nothing."""

from dataclasses import dataclass
from typing import Literal

from advisor.flight.messages import FloatArray

Ink = Literal["measured", "fitted", "residual", "input", "limit", "prior"]
INKS: tuple[Ink, ...] = ("measured", "fitted", "residual", "input", "limit", "prior")


@dataclass(frozen=True, slots=True)
class Series:
    """One curve: values over the chart's x."""

    name: str
    x: FloatArray
    """Shape (n,), in the unit of the chart's x axis."""
    y: FloatArray
    """Shape (n,), in the unit of the chart's y axis; NaN breaks a line."""
    ink: Ink
    mark: Literal["line", "points"] = "line"


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line: a limit, a prior value."""

    name: str
    y: float
    ink: Ink = "limit"


@dataclass(frozen=True, slots=True)
class Chart:
    """Everything one plot widget draws."""

    y_label: str
    """Quantity and unit, e.g. ``q [deg/s]``."""
    x_label: str
    """Quantity and unit, e.g. ``t [s]``."""
    series: tuple[Series, ...] = ()
    levels: tuple[Level, ...] = ()
    why_empty: str = ""
    """Shown when there is no series."""
    whole_x: bool = False
    """Ticks only at whole numbers (counts)."""
    log_y: bool = False
    """Equal ratios of y take equal room: 25 and 2,500 both read. Only positive values are drawn."""
