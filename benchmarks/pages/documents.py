"""``reference/json.md``: every key of every JSON document, from the schema files."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

Schema = Mapping[str, Any]

_HEAD = """# JSON documents

With `--json` a command writes one JSON document to standard output, and nothing else there. Numbers have SI
units (rad, rad/s, m/s, s) unless a key says otherwise (`_deg`, `_us`, `_percent`, `_hz`, `_ms`). A missing
number is `null`. Times are seconds since the autopilot booted.

With unusable input the document still comes, with `"usable": false`, and the exit code is 3.

The schema files below hold for every document of their kind; a test checks them against real output. Later
versions may add keys. In the tables `[]` stands for each element of a list and `*` for each key of a mapping.
"""
_ORDER = ("analyze", "gap", "doctor", "aircraft", "study")


def page(folder: Path) -> str:
    """The page as Markdown."""
    return "\n".join([_HEAD, *(_section(name, _read(folder / f"{name}.json")) for name in _ORDER)])


def _read(path: Path) -> Schema:
    content: Schema = json.loads(path.read_text(encoding="utf-8"))
    return content


def _section(name: str, schema: Schema) -> str:
    rows = [f"| {_broken(path)} | {kind} | {meaning} |" for path, kind, meaning in _keys(schema, schema, "")]
    table = "\n".join(["| key | value | meaning |", "|---|---|---|", *rows])
    return f"## `{schema['title']}`\n\nSchema: [`{schema['$id']}`](schemas/{name}.json).\n\n{table}\n"


def _broken(path: str) -> str:
    """The path as code that may break behind each point."""
    return f"<code>{path.replace('.', '.<wbr>')}</code>"


def _keys(part: Schema, whole: Schema, path: str) -> Iterator[tuple[str, str, str]]:
    """Yield path, type and meaning of every key below a part of the schema."""
    for name, given in part.get("properties", {}).items():
        found = _resolved(given, whole)
        below = f"{path}{name}"
        yield below, _type(found), given.get("description") or found.get("description", "")
        yield from _within(found, whole, below)


def _within(found: Schema, whole: Schema, path: str) -> Iterator[tuple[str, str, str]]:
    if "items" in found:
        yield from _within(_resolved(found["items"], whole), whole, f"{path}[]")
    elif isinstance(found.get("additionalProperties"), Mapping):
        yield from _within(_resolved(found["additionalProperties"], whole), whole, f"{path}.*")
    else:
        yield from _keys(found, whole, f"{path}.")


def _resolved(part: Schema, whole: Schema) -> Schema:
    """The definition that a part refers to; of another key only its type, because its own rows tell more."""
    if "$ref" not in part:
        return part
    _, home, name = part["$ref"].split("/")
    found: Schema = whole[home][name]
    return found if home == "$defs" else {"type": found.get("type", "any")}


def _type(part: Schema) -> str:
    if "const" in part:
        return f"`{part['const']}`"
    if "enum" in part:
        return ", ".join(f"`{json.dumps(value)}`" for value in part["enum"])
    kinds = part.get("type", "any")
    return kinds if isinstance(kinds, str) else " or ".join(kinds)
