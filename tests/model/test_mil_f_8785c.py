"""The boundaries of Figures 1 to 3 and of Table IV of MIL-F-8785C, each passed from one side to the other."""

from math import inf

import pytest

from advisor.model.mil_f_8785c import CATEGORIES, LIMITS, assess


def levels_of(*numbers: float) -> str:
    """Return damping, CAP, frequency, n/α to the levels in the categories A, B and C."""
    measured = [(number, (number, number)) for number in numbers]
    return "".join(str(assess(category, LIMITS[category], measured).level) for category in CATEGORIES)


BELOW, ABOVE = 1.0 - 1e-9, 1.0 + 1e-9


@pytest.mark.parametrize(
    ("cap", "frequency", "load", "levels"),
    [
        (0.28 * ABOVE, 2.0, 10.0, "111"),
        (0.28 * BELOW, 2.0, 10.0, "211"),
        (3.6 * ABOVE, 2.0, 10.0, "222"),
        (10.0 * ABOVE, 2.0, 10.0, "333"),
        (0.16 * BELOW, 2.0, 10.0, "412"),
        (0.096 * BELOW, 2.0, 10.0, "414"),
        (0.085 * BELOW, 2.0, 10.0, "424"),
        (0.038 * BELOW, 2.0, 10.0, "444"),
        (1.0, 1.0 * BELOW, 10.0, "211"),
        (1.0, 0.87 * BELOW, 10.0, "212"),
        (1.0, 0.6 * BELOW, 10.0, "313"),
        (1.0, 2.0, 2.7 * BELOW, "112"),
        (1.0, 2.0, 1.8 * BELOW, "113"),
    ],
)
def test_frequency_against_acceleration_sensitivity(cap, frequency, load, levels):
    assert levels_of(0.7, cap, frequency, load) == levels


@pytest.mark.parametrize(
    ("damping", "levels"),
    [
        (0.35, "111"), (0.35 * BELOW, "212"), (0.30 * BELOW, "222"), (0.25 * BELOW, "323"),
        (0.20 * BELOW, "333"), (0.15 * BELOW, "444"), (1.30 * ABOVE, "212"), (2.00 * ABOVE, "333"),
    ],
)  # fmt: skip
def test_damping(damping: float, levels: str) -> None:
    assert levels_of(damping, 1.0, 2.0, 10.0) == levels


def test_the_levels_that_the_intervals_reach_on_either_side_are_said() -> None:
    sure, unsure = (
        [(0.7, (0.7, 0.7)), (3.64, cap), (9.0, (9.0, 9.0)), (23.0, (23.0, 23.0))]
        for cap in ((3.62, 3.66), (3.4, 10.5))
    )
    assert assess("A", LIMITS["A"], sure).sentence == "Category A: Level 2"
    assert assess("A", LIMITS["A"], unsure).sentence == (
        "Category A: Level 2; the 95 % intervals reach Level 1 and Level 3"
    )


def test_what_no_level_allows_is_worse_than_the_third() -> None:
    measured = [(number, (number, number)) for number in (0.1, 1.0, 2.0, 10.0)]
    assert assess("B", LIMITS["B"], measured).sentence == "Category B: worse than Level 3"


_OPEN = (0.0, inf)
PRINTED: dict[str, tuple[dict[str, tuple[float, float]], ...]] = {
    "A": (
        {"damping": (0.35, 1.30), "cap": (0.28, 3.6), "frequency": (1.0, inf)},
        {"damping": (0.25, 2.00), "cap": (0.16, 10.0), "frequency": (0.6, inf)},
        {"damping": (0.15, inf), "cap": (0.16, inf)},
    ),
    "B": (
        {"damping": (0.30, 2.00), "cap": (0.085, 3.6)},
        {"damping": (0.20, 2.00), "cap": (0.038, 10.0)},
        {"damping": (0.15, inf), "cap": (0.038, inf)},
    ),
    "C": (
        {"damping": (0.35, 1.30), "cap": (0.16, 3.6), "frequency": (0.87, inf), "load": (2.7, inf)},
        {"damping": (0.25, 2.00), "cap": (0.096, 10.0), "frequency": (0.6, inf), "load": (1.8, inf)},
        {"damping": (0.15, inf), "cap": (0.096, inf)},
    ),
}
"""Limits of Levels 1 to 3 as the specification prints them, read anew and not from the module."""
INSIDE = {"damping": 0.7, "cap": 1.0, "frequency": 5.0, "load": 10.0}
"""Values within Level 1 of every category, in the order of the limits."""
BOUNDS = [
    (category, level, name, end)
    for category, levels in PRINTED.items()
    for level in range(1, len(levels) + 1)
    for name in INSIDE
    for end in (0, 1)
]


def level_of(category: str, **changed: float) -> int:
    """Return the level of values that are within Level 1 but for those changed."""
    measured = [(value, (value, value)) for value in (INSIDE | changed).values()]
    return assess(category, LIMITS[category], measured).level  # type: ignore[index, arg-type]


@pytest.mark.parametrize(("category", "level", "name", "end"), BOUNDS)
def test_every_printed_limit_holds_to_the_last_digit(category: str, level: int, name: str, end: int) -> None:
    """A value at the limit has the level or a better one. A value beyond the limit has a worse one."""
    bound = PRINTED[category][level - 1].get(name, _OPEN)[end]
    if bound in _OPEN:
        assert level_of(category, **{name: (1e-9, 1e9)[end]}) <= level
    else:
        assert level_of(category, **{name: bound}) <= level
        assert level_of(category, **{name: bound * (BELOW, ABOVE)[end]}) > level
