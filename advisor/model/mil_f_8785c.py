"""The short-period requirements of MIL-F-8785C, *Flying Qualities of Piloted Airplanes* (5 November 1980).

Paragraph 3.2.2.1.1 (Figures 1 to 3) bounds the natural frequency ω_n against the acceleration sensitivity
n/α. The bounds are lines of constant ω_n²/(n/α), the control anticipation parameter CAP. Least values of ω_n
and, in Category C, of n/α are added. Paragraph 3.2.2.1.2 (Table IV) bounds the damping ratio. The least
values in Category C are those of Classes I, II-C and IV, as MIL-STD-1797A prints them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Literal, NamedTuple

SOURCE = "MIL-F-8785C, paragraph 3.2.2.1, Classes I, II-C and IV"
MANNED = (
    "The criterion was written for manned aeroplanes; for small unmanned aircraft it is a comparison only."
)
Category = Literal["A", "B", "C"]
CATEGORIES: Mapping[Category, str] = {
    "A": "rapid manoeuvring, precise tracking",
    "B": "gradual manoeuvres: climb, cruise, loiter",
    "C": "take-off, approach, landing",
}
WORSE = 4
"""Number of the level worse than Level 3."""

Range = tuple[float, float]


class ShortPeriodLimits(NamedTuple):
    """Limits of one level in one category."""

    damping: Range
    """Limits of the damping ratio."""
    cap: Range
    """Limits of the control anticipation parameter ω_n²/(n/α), rad²/s² per g/rad."""
    frequency: Range
    """Limits of the natural frequency ω_n, rad/s."""
    load: Range
    """Limits of the acceleration sensitivity n/α, g/rad."""


_ANY = (0.0, inf)
LIMITS: Mapping[Category, tuple[ShortPeriodLimits, ShortPeriodLimits, ShortPeriodLimits]] = {
    "A": (
        ShortPeriodLimits((0.35, 1.30), (0.28, 3.6), (1.0, inf), _ANY),
        ShortPeriodLimits((0.25, 2.00), (0.16, 10.0), (0.6, inf), _ANY),
        ShortPeriodLimits((0.15, inf), (0.16, inf), _ANY, _ANY),
    ),
    "B": (
        ShortPeriodLimits((0.30, 2.00), (0.085, 3.6), _ANY, _ANY),
        ShortPeriodLimits((0.20, 2.00), (0.038, 10.0), _ANY, _ANY),
        ShortPeriodLimits((0.15, inf), (0.038, inf), _ANY, _ANY),
    ),
    "C": (
        ShortPeriodLimits((0.35, 1.30), (0.16, 3.6), (0.87, inf), (2.7, inf)),
        ShortPeriodLimits((0.25, 2.00), (0.096, 10.0), (0.6, inf), (1.8, inf)),
        ShortPeriodLimits((0.15, inf), (0.096, inf), _ANY, _ANY),
    ),
}
"""Levels 1 to 3 of each category of flight phases."""


@dataclass(frozen=True, slots=True)
class LevelFound:
    """The level of a mode in one category of flight phases; 4 is worse than Level 3."""

    category: Category
    level: int
    """Level of the estimated values, without regard to their intervals."""
    best_level: int
    """Best level within the 95 % intervals."""
    worst_level: int
    """Worst level within the 95 % intervals."""

    @property
    def sentence(self) -> str:
        """The level in words, with the levels that the intervals do not exclude."""
        spoken = f"Category {self.category}: {_spoken(self.level)}"
        others = [level for level in (self.best_level, self.worst_level) if level != self.level]
        if not others:
            return spoken
        return f"{spoken}; the 95 % intervals reach {' and '.join(map(_spoken, others))}"


def _spoken(level: int) -> str:
    return "worse than Level 3" if level == WORSE else f"Level {level}"


Measured = tuple[float, Range]
"""One parameter of the requirements: its value and its 95 % interval."""


def assess(category: Category, limits: Sequence[Sequence[Range]], measured: Sequence[Measured]) -> LevelFound:
    """Return the level of a mode, and the best and the worst level within its intervals.

    Parameters
    ----------
    limits
        Limits of Levels 1 to 3, each with one range for every parameter. Every level includes better ones.
    measured
        Parameters in the order and in the units of the limits.
    """
    values, intervals = [(value, value) for value, _ in measured], [interval for _, interval in measured]

    def first(ranges: Sequence[Range], agrees: Callable[[Range, Range], bool]) -> int:
        levels = (level for level, limit in enumerate(limits, start=1) if all(map(agrees, ranges, limit)))
        return next(levels, WORSE)

    return LevelFound(
        category, first(values, _lies_within), first(intervals, _overlaps), first(intervals, _lies_within)
    )


def _lies_within(interval: Range, limit: Range) -> bool:
    return limit[0] <= interval[0] and interval[1] <= limit[1]


def _overlaps(interval: Range, limit: Range) -> bool:
    return limit[0] <= interval[1] and interval[0] <= limit[1]
