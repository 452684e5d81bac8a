"""First expectations file from a flight. A second flight lies within the tolerances of this file."""

from collections.abc import Iterator, Mapping
from math import isfinite, sqrt
from typing import Any

from scipy.special import ndtri

from advisor.expectations.check import UNITS
from advisor.expectations.flown import Flown, Measured
from advisor.words.problems import printable
from advisor.words.quantities import decimals_for

_ALL_HOLD = 0.95
"""Probability with which every number of a second flight of the same aircraft lies within its tolerance."""
_OF_TRIM = ("Z_0", "M_0")
"""Parameters of the trim, which differ in a flight at another speed or weight."""
_WORST_ASKED = 3
"""Worst level that a file can ask for."""


def draft(flown: Flown, log: str) -> str:
    """Return the text of an expectations file that the flight fulfils.

    A tolerance is z·√2·σ: the difference of two flights has √2 times the standard deviation σ of one. With n
    numbers, z is the normal quantile at which all n differences lie within their tolerances in 95 % of the
    second flights.
    """
    by_section = {
        section: {
            name: measured
            for name, measured in getattr(flown, section).items()
            if isfinite(measured.std) and name not in _OF_TRIM
        }
        for section in ("derivatives", "modes")
    }
    count = sum(map(len, by_section.values()))
    z = sqrt(2.0) * float(ndtri(0.5 + 0.5 * _ALL_HOLD ** (1.0 / max(count, 1))))
    return "\n".join([*_counts(flown, log), *_numbers(by_section, z), *_rest(flown), ""])


def _counts(flown: Flown, log: str) -> Iterator[str]:
    yield f"# Expectations from {printable(log)}. To check another flight, type: advisor expect LOG THIS-FILE"
    yield "# Units are SI, angles rad. `of` takes a number, model (aircraft file) or log (of the key log)."
    accepted = {axis: count for axis, count in flown.accepted.items() if count}
    if accepted:
        yield f"accepted: {_inline(accepted)}  # manoeuvres, at least"
    complete = {a: t.stopped_at for a, t in flown.tests.items() if t.decision == "stop" and t.stopped_at}
    if complete:
        yield f"complete: {_inline(complete)}  # by this manoeuvre"


def _numbers(by_section: Mapping[str, Mapping[str, Measured]], z: float) -> Iterator[str]:
    for section, numbers in by_section.items():
        if numbers:
            share = f"{100.0 * _ALL_HOLD:.0f} %"
            yield f"{section}:  # within: in {share} of second flights every number holds"
        for name, measured in numbers.items():
            within = z * measured.std
            decimals = decimals_for(within)
            # Rounded up, so that the flight itself never fails by the rounding.
            text = f"{{of: {measured.value:.{decimals}f}, within: {within + 10.0**-decimals:.{decimals}f}}}"
            yield f"  {name}: {text}" + (f"  # {UNITS[name]}" if UNITS[name] else "")


def _rest(flown: Flown) -> Iterator[str]:
    levels = {
        axis: {level.category: level.level for level in of_axis if level.level <= _WORST_ASKED}
        for axis, of_axis in flown.levels.items()
    }
    if any(levels.values()):
        yield "levels:  # of MIL-F-8785C, by category of flight phases: this one or better"
        yield from (f"  {axis}: {_inline(worst)}" for axis, worst in levels.items() if worst)
    yield f"alarms: {len(flown.alarms)}  # at most"


def _inline(values: Mapping[Any, object]) -> str:
    return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"
