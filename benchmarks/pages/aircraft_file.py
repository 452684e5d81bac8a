"""``reference/aircraft-file.md``: every key of the aircraft file, from the classes that read it."""

import ast
import inspect
import textwrap
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any, Literal

from advisor.aircraft.aircraft import PARAMETERS, Aircraft

_HEAD = """# Aircraft file

The aircraft file is YAML. Every key may be left out, unknown keys are refused by name, and all mistakes are
listed at once with their path. This page is made from `advisor/aircraft/aircraft.py`.
[The how-to](../how-to/aircraft-file.md) says which keys to give first.

`model`, `campaign.parameters` and `campaign.tolerance` know the parameters {parameters}. Their units are rad
and s. The sizes in `effects` are those of [the effects](effects.md).
"""
_OF_NO_FILE = frozenset({"lag_found_s"})
"""Fields that the program fills: no key of the file."""
_UNITS = {
    "_m_s": "m/s", "_kg_m2": "kg m²", "_m2": "m²", "_kg": "kg", "_us": "us", "_deg": "deg", "_m": "m",
    "_s": "s", "_percent": "%", "_percent_chord": "% of the chord", "_c": "°C",
}  # fmt: skip
"""Ending of a key to the unit of its value."""


def page() -> str:
    """The page as Markdown."""
    names = ", ".join(f"`{name}`" for name in PARAMETERS)
    parts = [_HEAD.format(parameters=names)]
    plain = [f for f in fields(Aircraft) if _section_of(f, Aircraft) is None]
    parts.append(_table("The file", plain, Aircraft, ""))
    for field in fields(Aircraft):
        section = _section_of(field, Aircraft)
        if section is not None:
            parts += _sections(field.name, section)
    return "\n".join(parts)


def _sections(path: str, kind: type) -> Iterator[str]:
    """Yield the table of a section, then the tables of the sections within."""
    plain = [f for f in fields(kind) if _section_of(f, kind) is None and f.name not in _OF_NO_FILE]
    yield _table(f"`{path}`", plain, kind, f"{_first_sentence(kind)}\n\n")
    for field in fields(kind):
        within = _section_of(field, kind)
        if within is not None:
            several = "[]" if typing.get_origin(_hint(field, kind)) is tuple else ""
            yield from _sections(f"{path}.{field.name}{several}", within)


def _table(title: str, plain: list[Field[Any]], kind: type, lead: str) -> str:
    meanings = _meanings(kind)
    rows = [f"| `{f.name}` | {_value(f, kind)} | {_default(f)} | {meanings.get(f.name, '')} |" for f in plain]
    head = "| key | value | default | meaning |\n|---|---|---|---|"
    return "\n".join([f"## {title}\n", f"{lead}{head}", *rows]) + "\n"


def _hint(field: Field[Any], kind: type) -> Any:
    return typing.get_type_hints(kind)[field.name]


def _section_of(field: Field[Any], kind: type) -> type | None:
    """The dataclass that a key holds, one or several; None where the key holds a plain value."""
    for part in (_hint(field, kind), *typing.get_args(_hint(field, kind))):
        if isinstance(part, type) and is_dataclass(part):
            return part
    return None


def _type(hint: Any) -> str:
    origin, inside = typing.get_origin(hint), typing.get_args(hint)
    if origin is Literal:
        return ", ".join(f"`{value}`" for value in inside)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(_type(part) for part in inside if part is not type(None))
    if origin is not None and issubclass(origin, Mapping):
        return "mapping"
    if origin is tuple:
        return "list of pairs" if typing.get_origin(inside[0]) is tuple else f"list of {_type(inside[0])}"
    return {int: "whole number", float: "number", str: "text"}[hint]


def _value(field: Field[Any], kind: type) -> str:
    """Type and unit of a key's value."""
    return ", ".join(filter(None, (_type(_hint(field, kind)), _unit(field.name))))


def _unit(name: str) -> str:
    return next(
        (unit for ending, unit in sorted(_UNITS.items(), key=lambda e: -len(e[0])) if name.endswith(ending)),
        "",
    )


def _default(field: Field[Any]) -> str:
    value = field.default if field.default is not MISSING else ()
    if field.default is MISSING and field.default_factory is MISSING:
        return "required"
    if value is None or value == ():
        return "–"
    return ", ".join(f"`{one}`" for one in (value if isinstance(value, tuple) else (value,)))


def _first_sentence(kind: type) -> str:
    return (inspect.getdoc(kind) or "").split("\n\n")[0].replace("\n", " ").replace("``", "`")


def _meanings(kind: type) -> dict[str, str]:
    """The docstring below each field of a dataclass, from its source."""
    (defined,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
    found = {}
    assert isinstance(defined, ast.ClassDef)
    for node, below in zip(defined.body, defined.body[1:], strict=False):
        if (
            isinstance(node, ast.AnnAssign)
            and isinstance(node.target, ast.Name)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
        ):
            text = " ".join(str(below.value.value).split())
            found[node.target.id] = text.replace("``", "`").replace("|", "\\|")
    return found
