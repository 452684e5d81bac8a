"""Content of a plot: curves with units, horizontal levels, and a sentence that a plot without data shows."""

from dataclasses import dataclass
from typing import Literal

from advisor.process.arrays import FloatArray

Ink = Literal["measured", "fitted", "residual", "input", "limit", "prior"]
Mark = Literal["line", "points", "stems", "intervals"]
INKS: tuple[Ink, ...] = ("measured", "fitted", "residual", "input", "limit", "prior")


@dataclass(frozen=True, slots=True)
class Series:
    """One curve: values over the chart's x."""

    name: str
    x: FloatArray
    """Shape (n,), values of x in the unit of the chart's x axis."""
    y: FloatArray
    """Shape (n,), values of y in the unit of the chart's y axis; NaN interrupts a line."""
    ink: Ink
    mark: Literal["line", "points", "joined", "stems", "intervals"] = "line"
    """Shape of the curve. A joined series is a line with a stroke at each value, so that a single value is
    visible. A stem goes from 0 to the value. An interval is a value with a vertical bar of half-length
    ``half``.
    """
    half: FloatArray | None = None
    """Shape (n,), half of each interval in the unit of the y axis; None for other shapes."""


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line in a chart: a limit or a value for comparison."""

    name: str
    y: float
    ink: Ink = "limit"
    dashed: bool = True


@dataclass(frozen=True, slots=True)
class Chart:
    """Everything that one plot widget draws."""

    y_label: str
    """Quantity and unit of the y axis, such as ``q [deg/s]``."""
    x_label: str
    """Quantity and unit of the x axis, such as ``t [s]``."""
    series: tuple[Series, ...] = ()
    levels: tuple[Level, ...] = ()
    layer: Series | None = None
    """Curve of another quantity, scaled to the height of the plot."""
    why_empty: str = ""
    """Sentence that a plot without curves shows."""
    whole_x: bool = False
    """Whether the x axis has ticks only at whole numbers, for example for numbers of manoeuvres."""
    log_y: bool = False
    """Whether the y axis is logarithmic, so that 25 and 2,500 are both readable. Only positive values are
    drawn, and no intervals or stems."""
    x_range: tuple[float, float] | None = None
    """Ends of the x axis. With None the ends are rounded and include all data. The mouse can point only into
    a plot with given ends.
    """
    cursor: float | None = None
    """Value of x at which a vertical line stands. The legend shows the value of each series there."""
    foot: bool = True
    """Whether the x axis has labels. If several plots have a common x axis, only the lowest plot needs
    labels.
    """
    gutter: int = 0
    """Least width of the labels of the y axis, so that all plots of a column are aligned."""
