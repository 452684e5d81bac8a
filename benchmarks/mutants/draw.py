"""Mutants drawn by a seed: one change a line, from all rooms.

The draw orders the lines by a hash of seed, file and text, so that a change of one file leaves the mutants of
the other files.
"""

import ast
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from benchmarks.mutants.lines import Change, changes_of, compared_names

_COMPILED = "@kernel"
"""Mark of a module of machine code, which decides nothing and takes a minute to compile."""


@dataclass(frozen=True)
class Mutant:
    """One changed line of one file."""

    file: str
    """File under the root of the tree."""
    change: Change
    before: str
    after: str
    """Text of the line before and after the change."""


def draw(root: Path, seed: int, count: int) -> list[Mutant]:
    """Return mutants of different lines, in the order of the draw.

    Parameters
    ----------
    root
        Root of the tree.
    seed
        Seed of the draw.
    count
        Mutants wanted. Fewer are returned where fewer lines decide.
    """
    texts = {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted((root / "advisor").rglob("*.py"))
    }
    compared = set[str]().union(*(compared_names(ast.parse(text)) for text in texts.values()))
    drawn: list[tuple[str, Mutant]] = []
    for file, text in texts.items():
        if _COMPILED not in text:
            by_line: dict[int, list[Change]] = {}
            for change in changes_of(text, compared):
                by_line.setdefault(change.line, []).append(change)
            for line, changes in by_line.items():
                before = text.splitlines()[line - 1].strip()
                order = sha256(f"{seed}:{file}:{before}".encode()).hexdigest()
                change = changes[int(order, 16) % len(changes)]
                after = change.apply(text).splitlines()[line - 1].strip()
                drawn.append((order, Mutant(file, change, before, after)))
    return [mutant for _, mutant in sorted(drawn, key=lambda each: each[0])[:count]]
