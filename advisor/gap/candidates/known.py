"""What the simulator under diagnosis has already: the effects that stand in its aircraft file.

They are in every model from the start, so that a file which ``advisor gap`` improved is judged as it flies,
and what is found is what is missing beyond it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.messages import FloatArray
from advisor.gap.candidates.bent import as_in_file
from advisor.gap.candidates.moment import PROPELLER
from advisor.gap.candidates.traits import OF_ONE_FLIGHT, TRAITS
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights

Effects = Mapping[str, Mapping[str, float]]
"""Effect name to its parameters, as the aircraft file has them."""


def with_known(
    base: FloatArray, effects: Effects, flights: Flights, variants: Sequence[Variant]
) -> FloatArray:
    """Shape (manoeuvres, entries): the simulation's numbers, ``base`` (entries,), with the file's effects."""
    numbers = np.tile(base, (len(flights), 1))
    for effect, parameters in effects.items():
        if effect in OF_ONE_FLIGHT:
            continue
        described = [w for v in variants if v.effect == effect for w in (v, *v.likewise)]
        meant = [w for w in described if _says(w, parameters)]
        for variant in sorted(meant, key=lambda v: (-len(v.fixed), -len(v.names)))[:1]:
            as_said = as_in_file(variant, parameters, flights)
            as_said.apply(numbers, _values(variant, parameters), flights)
    return numbers


def beyond_known(effects: Effects, variants: Sequence[Variant]) -> list[Variant]:
    """The candidates left: a single number may be more or less than the file says, a shape is what it is."""
    left = []
    for variant in variants:
        known = effects.get(variant.effect, {}) if variant.effect not in OF_ONE_FLIGHT else {}
        if known.keys().isdisjoint(variant.names):
            left.append(variant)
        elif len(variant.names) == 1 and not variant.inverted and _is_meant(variant, known, variants):
            left.append(_beyond(variant, known[variant.names[0]]))
    return left


def beyond_servo(aircraft: Aircraft, variants: Sequence[Variant]) -> list[Variant]:
    """The candidates, a lag or a delay of the servo counted from what the aircraft file states of it.

    A servo may be quicker than the file says, and a stated delay may not be there.
    """
    found = []
    for variant in variants:
        stated = None if variant.fixed else stated_in(aircraft, variant.effect)
        found.append(_beyond(variant, stated) if stated else variant)
    return found


def less_of_the_servo(
    aircraft: Aircraft, effects: Effects
) -> tuple[Aircraft, dict[str, Mapping[str, float]]]:
    """The aircraft whose servo is quicker than its file says, and the effects without what made it so.

    No simulator flies an effect of less than nothing: that is taken off the number that the file states.
    """
    rest = dict(effects)
    changed: dict[str, Any] = {}
    for effect, values in effects.items():
        where, stated = TRAITS[effect].stated, stated_in(aircraft, effect)
        less = 0.0 if where is None or where[0] != "elevator" else values.get(where[1], 0.0)
        if where is not None and stated and less < 0.0:
            changed[where[1]] = max(stated + less, 0.0)
            del rest[effect]
    return replace(aircraft, elevator=replace(aircraft.elevator, **changed)), rest


def stated_in(aircraft: Aircraft, effect: str) -> float | None:
    """What the aircraft file states of an effect as a number of its own; None where that is nothing."""
    where = TRAITS[effect].stated
    stated: float | None = None if where is None else getattr(getattr(aircraft, where[0]), where[1])
    return stated


def left_aside(effects: Effects) -> tuple[str, ...]:
    """Effects of the file that belong to the flight in which they were found."""
    return tuple(effect for effect in effects if effect in OF_ONE_FLIGHT)


def together(known: Effects, found: Effects) -> dict[str, dict[str, float]]:
    """The file's effects and what was found beyond them.

    Beyond a known effect one number was searched for, its first: that adds. What else is said of it (the
    damping of a servo) replaces, as does the propeller's share, which counts from nothing; the rest stays.
    """
    both = {effect: dict(values) for effect, values in known.items()}
    for effect, values in found.items():
        before = both.get(effect, {}) if effect not in OF_ONE_FLIGHT else {}
        both[effect] = before | dict(values)
        for size in [name for name in values if name not in PROPELLER.names][:1]:
            both[effect][size] += before.get(size, 0.0)
    return both


def _beyond(variant: Variant, known: float) -> Variant:
    """The candidate counted from what the file has of it; it may take that away, where none is below zero."""
    (lowest, highest), starts = variant.bounds[0], variant.starts
    if known > 0.0 and lowest >= 0.0:
        lowest, starts = -known, (*starts, (-0.5 * known,))
    elif known < 0.0 and highest <= 0.0:
        highest, starts = -known, (*starts, (-0.5 * known,))
    beyond = replace(variant, starts=starts, bounds=((lowest, highest),))
    if not variant.sets:
        return beyond

    def apply(p: FloatArray, values: Values, flights: Flights) -> None:
        variant.apply(p, [known + values[0]], flights)

    return replace(beyond, apply_with=apply)


def _says(variant: Variant, parameters: Mapping[str, float]) -> bool:
    same = all(parameters.get(name) == value for name, value in variant.fixed.items())
    if variant.effect == "structural_mode":
        return same and "frequency_hz" in parameters
    return same and all(name in parameters for name in variant.names)


def _is_meant(variant: Variant, parameters: Mapping[str, float], variants: Sequence[Variant]) -> bool:
    """Whether it says what the file has, and none of its effect says more of what is not searched for."""
    same = [v for v in variants if v.effect == variant.effect and _says(v, parameters)]
    return _says(variant, parameters) and all(len(v.fixed) <= len(variant.fixed) for v in same)


def _values(variant: Variant, parameters: Mapping[str, float]) -> list[float]:
    """Of the variant's numbers, from the file's: the reverse of ``causes.parameters_of``."""
    if variant.effect == "structural_mode":
        return [
            parameters.get("displacement_gain", 0.0), parameters.get("gain", 0.0),
            2.0 * np.pi * parameters["frequency_hz"], parameters.get("damping", 0.0),
        ]  # fmt: skip
    values = [parameters[name] for name in variant.names]
    return [1.0 / max(values[0], 1e-9), *values[1:]] if variant.inverted else values
