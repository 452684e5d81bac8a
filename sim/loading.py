"""Frozen dataclasses from plain mappings, with every mistake listed by its path."""

import types
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")


class ScenarioError(ValueError):
    """A user's file has mistakes, all listed in ``problems``."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("; ".join(problems))
        self.problems = list(problems)


class DepartureError(ScenarioError):
    """The aircraft departs from flight: its motion grows without bound."""


def load(kind: type[T], data: Mapping[str, Any]) -> T:
    """Build a ``kind`` from a mapping.

    Raises
    ------
    ScenarioError
        The mapping has unknown keys or wrong values, all reported at once.
    """
    problems: list[str] = []
    value = _mapping(kind, data, "", problems)
    if problems:
        raise ScenarioError(problems)
    result: T = value
    return result


def _mapping(kind: Any, data: Any, path: str, problems: list[str]) -> Any:
    if not isinstance(data, Mapping):
        problems.append(f"{path or 'file'}: must be a mapping")
        return None
    hints = get_type_hints(kind)
    known = [field.name for field in fields(kind)]
    prefix = f"{path}." if path else ""
    problems += [
        f"{prefix}{key}: unknown key, choose from {', '.join(known)}" for key in data if key not in known
    ]
    before = len(problems)
    values = {
        name: _value(hints[name], data[name], f"{prefix}{name}", problems) for name in known if name in data
    }
    return kind(**values) if len(problems) == before else None


def _value(hint: Any, value: Any, path: str, problems: list[str]) -> Any:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        if value is None and type(None) in arguments:
            return None
        (hint,) = (a for a in arguments if a is not type(None))
        return _value(hint, value, path, problems)
    if origin is Literal:
        if value not in arguments:
            problems.append(f"{path}: '{value}' is none of {', '.join(map(str, arguments))}")
        return value
    if origin is tuple:
        if not isinstance(value, list):
            problems.append(f"{path}: must be a list")
            return ()
        return tuple(_value(arguments[0], item, f"{path}[{i}]", problems) for i, item in enumerate(value))
    if origin is dict:
        if not isinstance(value, Mapping):
            problems.append(f"{path}: must be a mapping")
            return {}
        return {str(k): _value(arguments[1], v, f"{path}.{k}", problems) for k, v in value.items()}
    if is_dataclass(hint):
        return _mapping(hint, value, path, problems)
    return _scalar(hint, value, path, problems)


def _scalar(hint: Any, value: Any, path: str, problems: list[str]) -> Any:
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if hint in (int, str) and isinstance(value, hint) and not isinstance(value, bool):
        return value
    wanted = {float: "a number", int: "a whole number", str: "text"}[hint]
    problems.append(f"{path}: must be {wanted}, not {value!r}")
    return value
