"""Effects that the aircraft file already states for the simulator under diagnosis.

The effects of the aircraft file are part of every model. A diagnosis with an improved aircraft file therefore
finds the rest of the gap.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.nuisances import PROPELLER
from advisor.gap.effects import EFFECTS
from advisor.gap.kit.curve import as_in_file
from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.oem.instruments import COUPLING_PRIOR
from advisor.process.arrays import FloatArray

_IN_FILE = 1e-5
"""Relative precision of a number in the improved file, which has six digits."""
Effects = Mapping[str, Mapping[str, float]]
"""Parameters of each effect, by the effect's name, in the units of the aircraft file."""
AIR = frozenset(name for name, effect in EFFECTS.items() if effect.block == "air")
"""Effects of moving air, which no fit can carry from one flight to another."""


def base_entries(aircraft: Aircraft) -> FloatArray:
    """Return the simulator's inputs that the file states for servo and instruments, shape (entries,)."""
    base = np.zeros(len(ENTRIES))
    base[INDEX["lag_s"]] = aircraft.elevator.lag_s or 0.0
    base[INDEX["delay_s"]] = aircraft.elevator.delay_s or 0.0
    base[INDEX["vane_arm_m"]] = aircraft.alpha.vane_arm_m or 0.0
    base[INDEX["imu_arm_m"]] = aircraft.accelerometer.arm_m or 0.0
    base[INDEX["inertia_share"]] = COUPLING_PRIOR.mean
    return base


def with_known(
    base: FloatArray, effects: Effects, flights: PreparedManeuvers, variants: Sequence[Variant]
) -> FloatArray:
    """Return the simulator's inputs of each manoeuvre, shape (manoeuvres, entries), with the file's effects
    added."""
    numbers = np.tile(base, (len(flights), 1))
    for variant, values in _as_stated(lasting(effects), variants):
        variant.apply(numbers, values, flights)
    return numbers


def changes_in(effects: Effects, variants: Sequence[Variant]) -> tuple[tuple[Variant, Values], ...]:
    """Return the aircraft file's changes in flight, of mass, balance or ice, with their sizes."""
    return tuple(_as_stated({e: effects[e] for e in effects if EFFECTS[e].of_one_flight}, variants))


def _as_stated(effects: Effects, variants: Sequence[Variant]) -> Iterator[tuple[Variant, Values]]:
    """Yield the variant of each effect that describes most of the file's entry, and its values."""
    for effect, parameters in effects.items():
        described = [w for v in variants if v.effect == effect for w in (v, *v.likewise)]
        meant = [w for w in described if _says(w, parameters)]
        for variant in sorted(meant, key=lambda v: (-len(v.fixed), -len(v.names)))[:1]:
            yield as_in_file(variant, EFFECTS[effect].curve, parameters), _values(variant, parameters)


def beyond_known(effects: Effects, variants: Sequence[Variant]) -> list[Variant]:
    """Return the candidates for effects beyond those that the aircraft file states. An effect with one
    parameter may differ from the file's value; the shape of any other effect is fixed."""
    left = []
    for variant in variants:
        stated = {} if EFFECTS[variant.effect].of_one_flight else effects.get(variant.effect, {})
        if stated.keys().isdisjoint(variant.names):
            left.append(variant)
        elif len(variant.names) == 1 and not variant.inverted and _is_meant(variant, stated, variants):
            left.append(_beyond(variant, stated[variant.names[0]]))
    return left


def beyond_servo(aircraft: Aircraft, variants: Sequence[Variant]) -> list[Variant]:
    """Return the candidates with a servo's lag or delay counted from the value that the aircraft file states.

    A servo may be quicker than the file states, and a stated delay may not exist.
    """
    beyond = []
    for variant in variants:
        stated = None if variant.fixed else stated_in(aircraft, variant.effect)
        beyond.append(_beyond(variant, stated) if stated else variant)
    return beyond


def less_of_the_servo(
    aircraft: Aircraft, effects: Effects
) -> tuple[Aircraft, dict[str, Mapping[str, float]]]:
    """Return the aircraft with negative servo effects subtracted from its lag or delay, and the other
    effects.

    No simulator flies a negative lag or delay, so such a value is subtracted from the file's.
    """
    rest = dict(effects)
    changed: dict[str, Any] = {}
    for effect, values in effects.items():
        where, stated = EFFECTS[effect].stated, stated_in(aircraft, effect)
        less = 0.0 if where is None or where[0] != "elevator" else values.get(where[1], 0.0)
        if where is not None and stated and less < 0.0:
            changed[where[1]] = max(stated + less, 0.0)
            del rest[effect]
    return replace(aircraft, elevator=replace(aircraft.elevator, **changed)), rest


def stated_in(aircraft: Aircraft, effect: str) -> float | None:
    """Return the value that the aircraft file states for an effect; None if the file states no value."""
    where = EFFECTS[effect].stated
    stated: float | None = None if where is None else getattr(getattr(aircraft, where[0]), where[1])
    return stated


def lasting(effects: Effects) -> Effects:
    """Return the file's effects without those that belong to one flight alone."""
    return {name: values for name, values in effects.items() if not EFFECTS[name].of_one_flight}


def left_aside(effects: Effects, *shown: Collection[str]) -> tuple[str, ...]:
    """Return the names of the file's effects that a flight does not show."""
    return tuple(effect for effect in effects if not any(effect in some for some in shown))


def together(stated: Effects, added: Effects) -> dict[str, dict[str, float]]:
    """Return the aircraft file's effects combined with the newly found effects.

    The first parameter of a found effect adds to the file's value. Other parameters, such as the damping of a
    servo, replace the file's value.
    """
    both = {effect: dict(values) for effect, values in stated.items()}
    for effect, values in added.items():
        before = {} if EFFECTS[effect].of_one_flight else both.get(effect, {})
        both[effect] = before | dict(values)
        for size in [name for name in values if name not in PROPELLER.names][:1]:
            both[effect][size] += before.get(size, 0.0)
    return both


def _beyond(variant: Variant, stated: float) -> Variant:
    """Return the candidate counted from the file's value; the range includes the removal of that value."""
    (lowest, highest), starts = variant.bounds[0], variant.starts
    if stated > 0.0 and lowest >= 0.0:
        lowest, starts = -stated, (*starts, (-0.5 * stated,))
    elif stated < 0.0 and highest <= 0.0:
        highest, starts = -stated, (*starts, (-0.5 * stated,))
    beyond = replace(variant, starts=starts, bounds=((lowest, highest),))
    if not variant.sets:
        return beyond

    def apply(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
        variant.apply(p, [stated + values[0]], flights)

    return replace(beyond, apply_with=apply)


def _says(variant: Variant, parameters: Mapping[str, float]) -> bool:
    fixed = variant.fixed.items()
    same = all(
        np.isclose(parameters.get(name, np.nan), value, rtol=_IN_FILE, atol=0.0) for name, value in fixed
    )
    needed = list(variant.in_file)[:1] or variant.names
    return same and all(name in parameters for name in needed)


def _is_meant(variant: Variant, parameters: Mapping[str, float], variants: Sequence[Variant]) -> bool:
    """Return whether the variant describes the file's entry best among all variants."""
    same = [v for v in variants if v.effect == variant.effect and _says(v, parameters)]
    return _says(variant, parameters) and all(len(v.fixed) <= len(variant.fixed) for v in same)


def _values(variant: Variant, parameters: Mapping[str, float]) -> list[float]:
    """Return variant parameters from the aircraft file's entry: the inverse of ``causes.parameters_of``."""
    spelled = {name: (key, factor) for key, (name, factor) in variant.in_file.items()}
    if spelled:
        keys = [spelled[name] for name in variant.names]
        return [factor * parameters.get(key, 0.0) for key, factor in keys]
    values = [parameters[name] for name in variant.names]
    return [1.0 / max(values[0], 1e-9), *values[1:]] if variant.inverted else values
