"""The section ``effects`` of an aircraft file: its mistakes, and its schema from the catalogue of effects."""

import math
from collections.abc import Iterator, Mapping
from typing import Any


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
