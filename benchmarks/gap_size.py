"""How large the package, the gap diagnosis and the estimator are, and that no count passes its limit.

    python -m benchmarks.gap_size

Counted over ``advisor/gap`` are lines of code, without
docstrings, comments and blank lines, so that an explanation costs nothing; constants, which are names of
numbers; those among them that decide, by the kind in their docstring (``benchmarks.pages.constants``);
comparisons with the name of an effect or a block; and functions of a cyclomatic complexity above 15
(McCabe 1976). A new effect does not count: the folders that describe effects, ``EFFECTS``, are left out of
all counts but the last.

Counted over ``advisor/gap``, ``advisor/oem`` and ``advisor/model`` are lines of code, and files that name a
state, a control or an axis. Only ``TABLES`` may name these. A moved file stays counted, so that a count falls
only where a room is handed its axis.

Counted over ``advisor`` are lines of code, whose limit is the next hundred above, and bindings of names that
do not say what their value is, ``VAGUE``. ``make check`` and ``.ci/run`` fail above a limit.
"""

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

from advisor.gap.effects import EFFECTS as CATALOGUE
from advisor.gap.kit.effect import BLOCKS as BLOCKS_OF_EFFECTS
from benchmarks.pages.constants import DECIDES, rows_in

ROOM = Path(__file__).parents[1] / "advisor" / "gap"
ROOMS = (ROOM,)
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
LIMITS = {
    "lines of code": 7043,
    "constants": 207,
    "constants that decide": 25,
    "names compared": 11,
    "complex functions": 0,
    "lines of estimation": 16363,
    "lines of the package": 60900,
    "files naming an axis": 109,
    "vague names": 23,
}
"""Upper bound of each count."""
MOST_COMPLEX = 15
_LAYOUT = frozenset(
    {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
)
_BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.ExceptHandler, ast.comprehension, ast.match_case)


def main() -> int:
    """Print every count next to its limit; return 1 where a count is above its limit."""
    counts = counted()
    for name, count in counts.items():
        print(f"{name:22s}{count:7d}  limit {LIMITS[name]}{'  ABOVE' if count > LIMITS[name] else ''}")
    return int(any(count > LIMITS[name] for name, count in counts.items()))


def counted() -> dict[str, int]:
    """All counts, by the names of ``LIMITS``."""
    counts = dict.fromkeys(LIMITS, 0)
    for path in sorted(path for room in ROOMS for path in room.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        counts["complex functions"] += sum(_complexity(f) > MOST_COMPLEX for f in _functions(tree))
        if not any(path.is_relative_to(folder) for folder in EFFECTS):
            counts["lines of code"] += len(_lines_of_code(text, tree))
            rows = list(rows_in(tree))
            counts["constants"] += sum(len(row.values) for row in rows)
            counts["constants that decide"] += sum(len(row.values) for row in rows if row.kind == DECIDES)
            counts["names compared"] += sum(map(_compares_a_name, ast.walk(tree)))
    for path in sorted(path for room in ESTIMATION for path in room.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        counts["lines of estimation"] += len(_lines_of_code(text, tree))
        if not any(path.is_relative_to(folder) for folder in TABLES):
            counts["files naming an axis"] += not OF_AN_AXIS.isdisjoint(_words_of(tree))
    for path in ROOM.parent.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        counts["lines of the package"] += len(_lines_of_code(text, tree))
        counts["vague names"] += sum(_bound(node) in VAGUE for node in ast.walk(tree))
    return counts


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


def _lines_of_code(text: str, tree: ast.Module) -> set[int]:
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _LAYOUT:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(tree):
        match node:
            case ast.Expr(value=ast.Constant(value=str())):
                lines.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


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
