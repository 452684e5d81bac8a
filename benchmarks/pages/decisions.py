"""``reference/gap-decisions.md``: the numbers of ``advisor/gap`` that decide something, from its source."""

import ast
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.pages.constants import DECIDES, DESCRIBES, KINDS, Row, rows_in
from benchmarks.sizes import ROOM

_HEAD = """# The decisions of the gap diagnosis

This page is made from the source of `advisor/gap`.

Of {count} constants {deciding} decide: a comparison with them changes what is found, kept, named or said. A
constant is a name in capitals for numbers at the top of a module. The others decide nothing:

{kinds}

Left out are indices of arrays, and the descriptions of effects, whose bounds stand in
[the table of effects](effects.md). Units are SI, unless the meaning says otherwise. Neighbours without a
docstring stand with the next one that has one. [The method](../explanation/gap.md) says how the folders work
together.
"""
_FOLDERS = {
    "records": "what is usable of a log",
    "candidates": "the effects that may be added",
    "fitting": "the fit, the hold-out, the prior of the aircraft file",
    "noise": "the noise of the flight",
    "search": "the plain model, quick fits and moving air",
    "uncatalogued": "laws and checks outside the catalogue",
    "inference": "the evidence and the posterior of every explanation",
    "verdict": "the answer",
    "foresight": "what a flight could not show",
    "simulator": "the simulator under diagnosis",
}


def page(room: Path = ROOM) -> str:
    """The page as Markdown."""
    by_module = {path.relative_to(room): _rows_of(path) for path in sorted(room.rglob("*.py"))}
    told = {module: rows for module, rows in by_module.items() if rows}
    every = [row for rows in told.values() for row in rows]
    kinds = "\n".join(f"- {kind}: {meaning}." for kind, meaning in KINDS.items())
    parts = [_HEAD.format(count=_count(every), deciding=_count(every, DECIDES), kinds=kinds)]
    for folder in ("", *sorted(_first_folders(told), key=_place)):
        inside = {m: rows for m, rows in told.items() if _folder_of(m) == folder}
        if inside:
            parts.append(_section(folder, inside))
    return "\n".join(parts)


def _rows_of(path: Path) -> list[Row]:
    """Plain constants of a module; descriptions of effects stand in the table of effects."""
    rows = rows_in(ast.parse(path.read_text(encoding="utf-8")))
    return [row for row in rows if row.kind != DESCRIBES]


def _count(rows: Sequence[Row], *kinds: str) -> int:
    return sum(len(row.values) for row in rows if not kinds or row.kind in kinds)


def _first_folders(modules: Mapping[Path, list[Row]]) -> set[str]:
    return {_folder_of(module) for module in modules} - {""}


def _folder_of(module: Path) -> str:
    return module.parts[0] if len(module.parts) > 1 else ""


def _place(folder: str) -> tuple[int, str]:
    known = list(_FOLDERS)
    return (known.index(folder) if folder in known else len(known), folder)


def _section(folder: str, modules: Mapping[Path, list[Row]]) -> str:
    title = f"`{folder}`" if folder else "`advisor/gap`"
    what = _FOLDERS.get(folder, "")
    lines = [
        f"## {title}{': ' + what if what else ''}\n",
        "| module | name | value | kind | meaning |",
        "|---|---|---|---|---|",
    ]
    for module, rows in modules.items():
        name = f"`{module.as_posix().removeprefix(folder + '/')}`"
        for n, row in enumerate(rows):
            names = "<br>".join(f"`{key}`" for key, _ in row.values)
            values = "<br>".join(f"`{value}`" for _, value in row.values)
            where, kind = name if n == 0 else "", f"**{row.kind}**" if row.kind == DECIDES else row.kind
            lines.append(f"| {where} | {names} | {_cell(values)} | {kind} | {_cell(row.meaning) or '–'} |")
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("``", "`")
