"""Statements about effects and their sizes in a pilot's words."""

import math
from collections.abc import Sequence

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import stated_in
from advisor.gap.decision import differs_from_zero
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Cause


def what(cause: Cause, in_simulator: frozenset[str] = frozenset()) -> str:
    """Return the statement about an effect with its size.

    ``in_simulator`` holds the effects that the simulator already has; the size is then the difference.
    """
    sizes = _sizes(cause)
    effect = EFFECTS[cause.effect]
    # A lag that is not significant is not mentioned.
    telling = (
        name
        for name, value in cause.parameters.items()
        if name != "lag_s" or differs_from_zero(value.value, value.std)
    )
    put = next((effect.said_with[name] for name in telling if name in effect.said_with), effect.said)
    below = next(iter(sizes.values()), 0.0) < 0.0
    beyond = effect.said_beyond
    if cause.effect in in_simulator and beyond:
        put = beyond if isinstance(beyond, tuple) or not below else put
    if isinstance(put, str):
        return put.format(**sizes)
    return put[1 if below else 0].format(**{name: abs(size) for name, size in sizes.items()})


def or_else(first: Cause, causes: Sequence[Cause]) -> str:
    """Return words for the other effects that the data cannot distinguish from the first effect.

    A lag of the servo looks like a delay, and the reverse.
    """
    alike = [c for c in causes if c.effect in first.cannot_be_told_from and EFFECTS[c.effect].said_or]
    others = alike if EFFECTS[first.effect].said_or else []
    return "".join(f", or {EFFECTS[c.effect].said_or.format(**_sizes(c))}" for c in others)


def _sizes(cause: Cause) -> dict[str, float]:
    """Return the sizes of a cause in every unit of a statement."""
    sizes = {}
    for name, value in cause.parameters.items():
        sizes[name] = value.value
        sizes[f"{name}_ms"] = 1e3 * value.value
        sizes[f"{name}_deg"] = math.degrees(value.value)
        sizes[f"{name}_percent"] = 100.0 * value.value
        sizes[f"{name}_power"] = 2.0 + value.value
    return sizes


def in_simulator(aircraft: Aircraft) -> frozenset[str]:
    """Return the effects that the simulator already has, from the aircraft file."""
    # A simulator beyond eight parameters may have curves.
    return frozenset(
        name
        for name, effect in EFFECTS.items()
        if name in aircraft.effects
        or stated_in(aircraft, name)
        or (effect.curve is not None and aircraft.simulator is not None)
    )
