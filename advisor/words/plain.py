"""Results as plain values for JSON and YAML: mappings and lists of texts, truth values and finite numbers."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from math import isfinite
from numbers import Integral, Real
from typing import Any


def plain(value: Any) -> Any:
    """Return a dataclass as a mapping, a sequence as a list, and a number that is not finite as None."""
    if isinstance(value, float):  # most values; a look-up of abstract classes takes ten times as long
        return float(value) if isfinite(value) else None
    if value is None or isinstance(value, str | bool | Integral):
        return value
    if isinstance(value, Real):
        return float(value) if isfinite(value) else None
    if is_dataclass(value):
        return {attribute.name: plain(getattr(value, attribute.name)) for attribute in fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, Iterable) else value


def picked(result: Any, names: str) -> Any:
    """Return the named attributes of a result as a mapping of plain values; None for None."""
    return None if result is None else {name: plain(getattr(result, name)) for name in names.split()}
