"""``reference/gap-decisions.md``: the numbers of ``advisor/gap`` that decide something, from its source."""

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.gap_size import ROOM
from benchmarks.pages.constants import Constant, constants_in

_HEAD = """# The decisions of the gap diagnosis

This page is made from the source of `advisor/gap`.

{count} constants decide something. A constant is a name in capitals for numbers at the top of a module.
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
    "search": "which effects are added",
    "uncatalogued": "what no effect of the catalogue explains",
    "evidence": "the evidence on every alternative",
    "judge": "the probabilities of the alternatives",
    "verdict": "the answer",
    "foresight": "what a planned flight could show",
    "simulator": "the simulator under diagnosis",
}


@dataclass(frozen=True)
class Row:
    """Constants that one docstring explains."""

    values: tuple[tuple[str, str], ...]
    meaning: str


def page(room: Path = ROOM) -> str:
    """The page as Markdown."""
    by_module = {path.relative_to(room): list(rows_of(path)) for path in sorted(room.rglob("*.py"))}
    told = {module: rows for module, rows in by_module.items() if rows}
    count = sum(len(row.values) for rows in told.values() for row in rows)
    parts = [_HEAD.format(count=count)]
    for folder in ("", *sorted(_first_folders(told), key=_place)):
        inside = {m: rows for m, rows in told.items() if _folder_of(m) == folder}
        if inside:
            parts.append(_section(folder, inside))
    return "\n".join(parts)


def rows_of(path: Path) -> Iterator[Row]:
    """Yield the deciding constants of a module; neighbours without a docstring share the next one's."""
    waiting: list[Constant] = []
    for constant in constants_in(ast.parse(path.read_text(encoding="utf-8"))):
        if not constant.is_plain:
            continue
        if waiting and waiting[-1].line + 1 != constant.begins:
            yield _row(waiting)
            waiting = []
        waiting.append(constant)
        if constant.meaning:
            yield _row(waiting)
            waiting = []
    if waiting:
        yield _row(waiting)


def _row(constants: Sequence[Constant]) -> Row:
    values = tuple(value for constant in constants for value in constant.values)
    return Row(values, constants[-1].meaning)


def _first_folders(modules: dict[Path, list[Row]]) -> set[str]:
    return {_folder_of(module) for module in modules} - {""}


def _folder_of(module: Path) -> str:
    return module.parts[0] if len(module.parts) > 1 else ""


def _place(folder: str) -> tuple[int, str]:
    known = list(_FOLDERS)
    return (known.index(folder) if folder in known else len(known), folder)


def _section(folder: str, modules: dict[Path, list[Row]]) -> str:
    title = f"`{folder}`" if folder else "`advisor/gap`"
    what = _FOLDERS.get(folder, "")
    lines = [
        f"## {title}{': ' + what if what else ''}\n",
        "| module | name | value | meaning |",
        "|---|---|---|---|",
    ]
    for module, rows in modules.items():
        name = f"`{module.as_posix().removeprefix(folder + '/')}`"
        for n, row in enumerate(rows):
            names = "<br>".join(f"`{key}`" for key, _ in row.values)
            values = "<br>".join(f"`{value}`" for _, value in row.values)
            lines.append(
                f"| {name if n == 0 else ''} | {names} | {_cell(values)} | {_cell(row.meaning) or '–'} |"
            )
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("``", "`")
