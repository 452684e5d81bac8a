"""Checks of the sections ``estimation`` and ``effects`` of an aircraft file."""

import math
from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

from advisor.aircraft.added_term import parse_term
from advisor.aircraft.aircraft import Estimation
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.words.problems import ConfigurationError

NAMES = (*PARAMETERS, *SIDE_PARAMETERS)


def mistakes_in_estimation(estimation: Estimation) -> Iterator[str]:
    """Yield the mistakes in the section ``estimation`` of an aircraft file, as ``path: description``."""
    for name, value in estimation.fixed.items():
        if mistake := _mistake_in_fixed(name, value):
            yield f"estimation.fixed.{name}: {mistake}"
    for i, text in enumerate(estimation.terms):
        if mistake := _mistake_in_term(text, estimation.terms[:i], estimation.fixed):
            yield f"estimation.terms[{i}]: {mistake}"


def structure_of(
    fixes: Sequence[str], terms: Sequence[str], before: Estimation, model: Mapping[str, float]
) -> Estimation:
    """Return the structure with what ``--fix NAME[=VALUE]`` and ``--term EQUATION:EXPRESSION`` add.

    Parameters
    ----------
    before
        Structure in the aircraft file.
    model
        The file's derivatives, at which a parameter without a value is held.

    Raises
    ------
    ConfigurationError
        A parameter, a value or a term cannot be used.
    """
    fixed = dict(before.fixed)
    for text in fixes:
        name, value = _read_fix(text, model)
        fixed[name] = value
    every = list(before.terms)
    for text in terms:
        if mistake := _mistake_in_term(text, every, fixed):
            raise ConfigurationError(f"--term {text}: {mistake}.")
        every.append(parse_term(text).name)
    return Estimation(fixed, tuple(every))


def _read_fix(text: str, model: Mapping[str, float]) -> tuple[str, float]:
    """Return the name and the value of ``NAME[=VALUE]``."""
    name, equals, given = (part.strip() for part in text.partition("="))
    if not equals and name in NAMES:
        if name not in model:
            raise ConfigurationError(
                f"--fix {name}: the aircraft file's model has no {name}; give the value, "
                f"as in --fix {name}=-2.0, or name a file with --aircraft."
            )
        return name, float(model[name])
    try:
        value = float(given or 0.0)
    except ValueError:
        raise ConfigurationError(f"--fix {text}: {given!r} is no number; write --fix {name}=-2.0.") from None
    if mistake := _mistake_in_fixed(name, value):
        raise ConfigurationError(f"--fix {text}: {mistake}.")
    if not given:
        raise ConfigurationError(f"--fix {text}: there is no value; write --fix {name}=-2.0.")
    return name, value


def _mistake_in_fixed(name: str, value: float) -> str:
    if name not in NAMES:
        return f"{name!r} is no parameter; the parameters are {' '.join(NAMES)}"
    return "" if isfinite(value) else f"{value} is no value; give a number"


def _mistake_in_term(text: str, before: Sequence[str], fixed: Mapping[str, float]) -> str:
    try:
        term = parse_term(text)
    except ValueError as error:
        return str(error)
    if term.name in [parse_term(other).name for other in before]:
        return "the term is there already; leave it out"
    twin = f"{term.equation}_{term.expression}"
    if twin in NAMES and twin not in fixed:
        return f"{twin} is that term already; leave the term out, or hold {twin} with --fix"
    return ""


def mistakes_in(effects: Mapping[str, Mapping[str, float]]) -> Iterator[str]:
    """Yield every mistake in an aircraft file's ``effects``, as ``path: description``."""
    if not effects:
        return
    from advisor.gap.effects import EFFECTS  # not on the start path

    for name, sizes in effects.items():
        if name not in EFFECTS:
            yield f"effects.{name}: unknown effect, the effects are {' '.join(EFFECTS)}"
            continue
        keys = EFFECTS[name].keys
        for key, value in sizes.items():
            if key not in keys:
                yield f"effects.{name}.{key}: unknown key, the parameters are {' '.join(keys)}"
            elif value < keys[key]:
                yield f"effects.{name}.{key}: must not be below {keys[key]:g}, is {value:g}"


def effects_schema() -> dict[str, Any]:
    """Return the JSON schema of the section: every effect with its sentence and its parameters."""
    from advisor.gap.effects import EFFECTS
    from advisor.gap.kit.effect import without_sizes

    return {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            name: {
                "type": "object",
                "description": " / ".join(without_sizes(effect.said, "x")),
                "additionalProperties": False,
                "properties": {key: _number(least) for key, least in effect.keys.items()},
            }
            for name, effect in EFFECTS.items()
        },
    }


def _number(least: float) -> dict[str, Any]:
    return {"type": "number"} | ({"minimum": least} if math.isfinite(least) else {})
