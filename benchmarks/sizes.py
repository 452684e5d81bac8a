"""How large the house is, and that no count passes its bound.

    python -m benchmarks.sizes
    python -m benchmarks.sizes --lower

All lines of Python, with docstrings, blank lines and imports, and all files are counted over ``advisor``,
``tests``, ``benchmarks`` and ``sim``. Their bounds are the counts of the last landing. ``--lower`` writes the
counts of a landing that removes more than it adds, and nothing raises a bound. A landing that leaves a bound
above its count has forgotten ``--lower``.

Counted over ``advisor/gap`` are constants, which are names of numbers; those among them that decide, by the
kind in their docstring (``benchmarks.pages.constants``); comparisons with the name of an effect or a block;
and functions of a cyclomatic complexity above 15 (McCabe 1976). A new effect does not count: the folders that
describe effects, ``EFFECTS``, are left out of all counts but the last.

Counted over ``advisor/gap``, ``advisor/oem`` and ``advisor/model`` are files that name a state, a control or
an axis. Only ``TABLES`` may name these. A moved file stays counted, so that a count falls only where a room
is handed its axis. Counted over ``advisor`` are bindings of names that do not say what their value is,
``VAGUE``. ``make check`` and ``.ci/run`` fail above a bound.
"""

import ast
import json
import re
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from advisor.gap.effects import EFFECTS as CATALOGUE
from advisor.gap.kit.effect import BLOCKS as BLOCKS_OF_EFFECTS
from benchmarks.pages.constants import DECIDES, rows_in

ROOM = Path(__file__).parents[1] / "advisor" / "gap"
EFFECTS = (
    ROOM / "candidates",
    ROOM / "effects",
    ROOM / "kit",
    ROOM / "simulator",
)
"""Folders that describe effects, by their table and their equations."""
ESTIMATION = (ROOM, ROOM.parent / "oem", ROOM.parent / "model")
TABLES = (ROOM / "effects", ROOM.parent / "model" / "axes")
"""Folders that may name states, controls and axes: a table for each axis, and a file for each effect."""
OF_AN_AXIS = frozenset(
    {
        *("pitch", "lateral", "roll", "yaw", "elevator", "aileron", "rudder"),
        *("alpha", "beta", "theta", "bank", "p", "q", "r"),
    }
)
"""Names of axes, controls and states. A single letter counts as a text only, because a variable may have any
letter."""
NAMES = frozenset(CATALOGUE) | frozenset(BLOCKS_OF_EFFECTS) | {"attitude_sensor"}
VAGUE = frozenset({"found", "known", "one", "told"})
"""Names that fit any value. A variable is named by its value instead: optimum, posterior, record, lag."""
BOUNDS = Path(__file__).with_suffix(".json")
"""Upper bound of each count, by its name."""
WHOLE = ("advisor", "tests", "benchmarks", "sim")
"""Folders of which all lines and files are counted."""
MOST_COMPLEX = 15
_BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.ExceptHandler, ast.comprehension, ast.match_case)


def main(arguments: Sequence[str] = sys.argv[1:]) -> int:
    """Print every count next to its bound; return 1 where a bound does not fit."""
    counts, bounds = counted(), json.loads(BOUNDS.read_text(encoding="utf-8"))
    if "--lower" in arguments:
        bounds = {name: min(count, bounds.get(name, count)) for name, count in counts.items()}
        BOUNDS.write_text(json.dumps(bounds, indent=1) + "\n", encoding="utf-8")
    wrong = 0
    for name, count in counts.items():
        forgotten = count < bounds[name] and name.startswith(("lines of", "files of"))
        wrong += count > bounds[name] or forgotten
        said = "  ABOVE" if count > bounds[name] else "  lower the bound (--lower)" if forgotten else ""
        print(f"{name:24s}{count:7d}  bound {bounds[name]}{said}")
    return int(wrong > 0)


def counted() -> dict[str, int]:
    """All counts by their names."""
    counts: Counter[str] = Counter()
    for folder in WHOLE:
        files = sorted((ROOM.parents[1] / folder).rglob("*.py"))
        counts[f"lines of {folder}"] = sum(path.read_bytes().count(b"\n") for path in files)
        counts[f"files of {folder}"] = len(files)
    counts.update(dict.fromkeys(("constants", "constants that decide", "names compared"), 0))
    counts.update(dict.fromkeys(("complex functions", "files naming an axis", "vague names"), 0))
    for path in sorted(ROOM.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        counts["complex functions"] += sum(_complexity(f) > MOST_COMPLEX for f in _functions(tree))
        if not any(path.is_relative_to(folder) for folder in EFFECTS):
            rows = list(rows_in(tree))
            counts["constants"] += sum(len(row.values) for row in rows)
            counts["constants that decide"] += sum(len(row.values) for row in rows if row.kind == DECIDES)
            counts["names compared"] += sum(map(_compares_a_name, ast.walk(tree)))
    for path in sorted(path for room in ESTIMATION for path in room.rglob("*.py")):
        if not any(path.is_relative_to(folder) for folder in TABLES):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            counts["files naming an axis"] += not OF_AN_AXIS.isdisjoint(_words_of(tree))
    for path in ROOM.parent.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        counts["vague names"] += sum(_bound(node) in VAGUE for node in ast.walk(tree))
    return dict(counts)


def _bound(node: ast.AST) -> str:
    """Return the name that a variable, an argument or a function gets; empty for any other node."""
    match node:
        case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name) | ast.FunctionDef(name=name):
            return name
    return ""


def _words_of(tree: ast.Module) -> Iterator[str]:
    """Yield the words of names and of texts that are names, in lower case."""
    explained = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        match node:
            case ast.Constant(value=str(text)) if id(node) not in explained and text.isidentifier():
                yield from text.lower().split("_")
            case (
                ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.keyword(arg=str(name))
            ):
                yield from _parts(name)
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.alias(name=name):
                yield from _parts(name.rpartition(".")[2])


def _parts(name: str) -> Iterator[str]:
    words = re.sub("([a-z])([A-Z])", r"\1_\2", name).lower().split("_")
    return (word for word in words if len(word) > 1)


def _compares_a_name(node: ast.AST) -> bool:
    if not isinstance(node, ast.Compare):
        return False
    return any(isinstance(part, ast.Constant) and part.value in NAMES for part in ast.walk(node))


def _functions(tree: ast.Module) -> Iterator[ast.AST]:
    return (n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef))


def _complexity(function: ast.AST) -> int:
    return 1 + sum(isinstance(node, _BRANCHES) for node in ast.walk(function))


if __name__ == "__main__":
    sys.exit(main())
