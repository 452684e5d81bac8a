"""``reference/aircraft-file.md``: every key of the aircraft file, from the classes that read it."""

import inspect
import types
import typing
from collections.abc import Mapping
from typing import Any, Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.key import REQUIRED, Key, keys_of, sections_of
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS

_HEAD = """# Aircraft file

The aircraft file is YAML. Every key may be left out, unknown keys are refused by name, and all mistakes are
listed at once with their path. This page is made from `advisor/aircraft/aircraft.py`.
[The how-to](../how-to/aircraft-file.md) says which keys to give first.

`model`, `campaign.parameters` and `campaign.tolerance` know the parameters of pitch {parameters}.
`model` also knows those of roll and yaw: {sides}. Units are rad and s.
The sizes in `effects` are those of [the effects](effects.md).
"""


def page() -> str:
    """The page as Markdown."""
    names = ", ".join(f"`{name}`" for name in PARAMETERS)
    sides = ", ".join(f"`{name}`" for name in SIDE_PARAMETERS)
    parts = [_HEAD.format(parameters=names, sides=sides)]
    for path, section in sections_of(Aircraft):
        keys = [key for key in keys_of(section, path) if key.path.rpartition(".")[0] == path]
        title, lead = (f"`{path}`", f"{_first_sentence(section)}\n\n") if path else ("The file", "")
        parts.append(_table(title, keys, lead))
    return "\n".join(parts)


def _table(title: str, keys: list[Key], lead: str) -> str:
    rows = [f"| `{key.name}` | {_value(key)} | {_default(key)} | {_meaning(key)} |" for key in keys]
    head = "| key | value | default | meaning |\n|---|---|---|---|"
    return "\n".join([f"## {title}\n", f"{lead}{head}", *rows]) + "\n"


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


def _value(key: Key) -> str:
    """Type and unit of a key's value."""
    return ", ".join(filter(None, (_type(key.hint), key.unit)))


def _default(key: Key) -> str:
    if key.default is REQUIRED:
        return "required"
    if key.default is None or key.default in ((), {}):
        return "–"
    return ", ".join(
        f"`{one}`" for one in (key.default if isinstance(key.default, tuple) else (key.default,))
    )


def _meaning(key: Key) -> str:
    return key.meaning.replace("``", "`").replace("|", "\\|")


def _first_sentence(kind: type) -> str:
    return (inspect.getdoc(kind) or "").split("\n\n")[0].replace("\n", " ").replace("``", "`")
