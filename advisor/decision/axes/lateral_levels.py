"""Lateral requirements of MIL-F-8785C, *Flying Qualities of Piloted Airplanes* (5 November 1980).

Paragraph 3.3.1.1 (Table VI) sets lower limits of frequency ω, damping ζ and ζ·ω of the Dutch roll. Paragraph
3.3.1.2 (Table VII) sets an upper limit of the roll mode's time constant. Paragraph 3.3.1.3 (Table VIII) sets
a lower limit of the time in which the spiral doubles the bank. Not included are ζ of 0.4 for air combat and
ground attack, and the larger ζ·ω if ω²·|φ/β| exceeds 20 rad²/s².
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, log
from typing import Literal

from advisor.model.mil_f_8785c import CATEGORIES, WORSE, Category, LevelFound
from advisor.oem.axes.lateral.estimate import LateralModes
from advisor.oem.flying_qualities import Quality

SOURCE = "MIL-F-8785C, paragraphs 3.3.1.1 to 3.3.1.3"
Group = Literal["I, II-C, IV", "II-L, III"]
GROUPS: Mapping[Group, str] = {
    "I, II-C, IV": "light or highly manoeuvrable aircraft",
    "II-L, III": "medium and heavy aircraft",
}
"""Aircraft of each group of classes with equal requirements. Category A treats all of Class II as II-L."""
Mode = Literal["dutch_roll", "roll", "spiral"]
Least = tuple[float, ...]
"""Least values of the qualities for one level. Larger values of the quality are better."""

_DUTCH: Mapping[Group, Mapping[Category, Least]] = {
    "I, II-C, IV": {"A": (0.19, 0.35, 1.0), "B": (0.08, 0.15, 0.4), "C": (0.08, 0.15, 1.0)},
    "II-L, III": {"A": (0.19, 0.35, 0.4), "B": (0.08, 0.15, 0.4), "C": (0.08, 0.10, 0.4)},
}
"""Level 1 of the Dutch roll: least ζ, ζ·ω in rad/s, and ω in rad/s."""
_DUTCH_BELOW: tuple[Least, Least] = ((0.02, 0.05, 0.4), (0.0, -inf, 0.4))
"""Levels 2 and 3 of the Dutch roll, equal for every class and category."""
_ROLL: Mapping[Group, Mapping[Category, Least]] = {
    "I, II-C, IV": {"A": (1.0, 1.4, 10.0), "B": (1.4, 3.0, 10.0), "C": (1.0, 1.4, 10.0)},
    "II-L, III": dict.fromkeys(CATEGORIES, (1.4, 3.0, 10.0)),
}
"""Largest time constant of the roll mode in levels 1 to 3, s."""
_SPIRAL: Mapping[Category, Least] = {"A": (12.0, 8.0, 4.0), "B": (20.0, 8.0, 4.0), "C": (12.0, 8.0, 4.0)}
"""Least time to double the bank in levels 1 to 3, s."""


@dataclass(frozen=True, slots=True)
class LateralLevels:
    """Levels of the lateral modes for one group of classes in one category of flight phases."""

    group: Group
    category: Category
    by_mode: Mapping[Mode, LevelFound]
    """Level of every mode in the estimate, by the mode's name."""

    @property
    def governing(self) -> LevelFound:
        """Level of the worst mode."""
        found = self.by_mode.values()
        return LevelFound(
            self.category,
            max(one.level for one in found),
            max(one.best_level for one in found),
            max(one.worst_level for one in found),
        )


def lateral_levels(modes: LateralModes) -> tuple[LateralLevels, ...]:
    """Return the levels by group of classes and category; empty for an estimate without modes.

    The interval of ζ·ω is the product of both intervals' ends, which is wider than 95 %.
    """
    values = _values(modes)
    if not values:
        return ()
    return tuple(
        LateralLevels(
            group,
            category,
            {mode: _found(category, _limits(mode, group, category), *values[mode]) for mode in values},
        )
        for group in GROUPS
        for category in CATEGORIES
    )


def _values(modes: LateralModes) -> dict[Mode, tuple[Least, Least, Least]]:
    """Return each mode's value and 95 % interval; larger is better, so time constant and pole are negated."""
    found: dict[Mode, tuple[Least, Least, Least]] = {}
    zeta, omega = modes.dutch_roll_zeta, modes.dutch_roll_omega
    if zeta is not None and omega is not None:
        pairs = ((zeta.value, omega.value), *zip(zeta.ci95, omega.ci95, strict=True))
        at, low, high = ((z, z * w, w) for z, w in pairs)
        found["dutch_roll"] = at, low, high
    if modes.roll_time_constant is not None:
        found["roll"] = _negative(modes.roll_time_constant)
    if modes.spiral_pole is not None:
        found["spiral"] = _negative(modes.spiral_pole)
    return found


def _negative(quality: Quality) -> tuple[Least, Least, Least]:
    low, high = quality.ci95
    return (-quality.value,), (-high,), (-low,)


def _limits(mode: Mode, group: Group, category: Category) -> Sequence[Least]:
    if mode == "dutch_roll":
        return _DUTCH[group][category], *_DUTCH_BELOW
    if mode == "roll":
        return [(-longest,) for longest in _ROLL[group][category]]
    return [(-log(2.0) / doubled,) for doubled in _SPIRAL[category]]


def _found(category: Category, limits: Sequence[Least], at: Least, low: Least, high: Least) -> LevelFound:
    return LevelFound(category, *(_first(limits, values) for values in (at, high, low)))


def _first(limits: Sequence[Least], values: Least) -> int:
    """Return the first level whose least values are reached."""
    for level, least in enumerate(limits, start=1):
        if all(value >= limit for value, limit in zip(values, least, strict=True)):
            return level
    return WORSE
