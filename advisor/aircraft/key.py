"""Key of the aircraft file, with all texts that the file, its page and its check show."""

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

_UNITS = {
    "_kg_m2": "kg m²", "_percent_chord": "% of the chord", "_percent": "%", "_m_s": "m/s", "_m2": "m²",
    "_kg": "kg", "_us": "us", "_deg": "deg", "_hz": "Hz", "_m": "m", "_s": "s", "_c": "°C",
}  # fmt: skip
"""Unit of a key's value, by the ending of the key; longer endings come first."""
REQUIRED = object()
"""Default of a key that its section needs."""


@dataclass(frozen=True, slots=True)
class Key:
    """Metadata of one key, the only place that describes the key. A type carries it in ``Annotated``."""

    meaning: str
    """Quantity, sign, and the meaning of the default, in sentences."""
    example: str = ""
    """Value in YAML for the comment in a new file. Empty: a new file leaves the key out."""
    cost: str = ""
    """Sentence on the cost of the missing key. Empty: a missing key costs nothing."""
    mend: str = ""
    """Clause on how a crew finds the value."""
    positive: bool = False
    """Whether the value must be above 0."""
    within: tuple[float, float] | None = None
    """Least and largest value of the key."""
    path: str = ""
    """Sections and name, e.g. ``elevator.lag_s``, filled in by :func:`keys_of`."""
    hint: Any = None
    """Type of the value, filled in by :func:`keys_of`."""
    default: Any = REQUIRED
    """Value without the key, filled in by :func:`keys_of`."""

    @property
    def name(self) -> str:
        """Last part of the key's path."""
        return self.path.rpartition(".")[2]

    @property
    def unit(self) -> str:
        """Unit of the value by the ending of the name; empty without one."""
        return next((unit for ending, unit in _UNITS.items() if self.name.endswith(ending)), "")

    def mistake(self, value: Any) -> str:
        """Return the mistake of a number outside the bounds; empty for a number within the bounds or another
        value.
        """
        if not isinstance(value, int | float):
            return ""
        if self.positive and value <= 0.0:
            return f"must be above 0, is {value}"
        if self.within is not None and not self.within[0] <= value <= self.within[1]:
            low, high = self.within
            return f"{' '.join(filter(None, (str(value), self.unit)))} is outside {low:g}..{high:g}"
        return ""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> Any:
        """Return the schema for an editor, with meaning, unit and cost."""
        said = (self.meaning, f"Without it: {self.cost}" if self.cost else "")
        return {**handler(schema), "description": " ".join(filter(None, said))}


@cache
def keys_of(section: type, path: str = "") -> tuple[Key, ...]:
    """Return the keys of a section in the order of the file, including the keys of inner sections."""
    return tuple(_keys_of(section, path))


def _keys_of(section: type, path: str) -> Iterator[Key]:
    hints = get_type_hints(section, include_extras=True)
    for attribute in fields(section):
        at = f"{path}.{attribute.name}" if path else attribute.name
        inner, listed = section_in(hints[attribute.name])
        if inner is not None:
            yield from keys_of(inner, f"{at}[]" if listed else at)
        elif get_origin(hints[attribute.name]) is Annotated:
            hint, key = get_args(hints[attribute.name])
            made = attribute.default if attribute.default_factory is MISSING else attribute.default_factory()
            made = REQUIRED if made is MISSING else made
            yield replace(key, path=at, hint=hint, default=made)


def section_in(hint: Any) -> tuple[type | None, bool]:
    """Return the section that a key holds, and whether the key holds several; None if the key holds a plain
    value.
    """
    for part in (hint, *get_args(hint)):
        if isinstance(part, type) and is_dataclass(part):
            return part, get_origin(hint) is tuple
    return None, False


def sections_of(section: type, path: str = "") -> Iterator[tuple[str, type]]:
    """Yield a section with its path, then the sections within, in the order of the file."""
    yield path, section
    hints = get_type_hints(section)
    for attribute in fields(section):
        inner, listed = section_in(hints[attribute.name])
        if inner is not None:
            at = f"{path}.{attribute.name}" if path else attribute.name
            yield from sections_of(inner, f"{at}[]" if listed else at)
