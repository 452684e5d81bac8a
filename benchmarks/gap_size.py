"""How large the rules of the gap diagnosis are, and that no count of them passes its limit.

    python -m benchmarks.gap_size

Counted over ``advisor/gap`` are lines of code, without docstrings, comments and blank lines, so that an
explanation costs nothing; constants, which are names of numbers; those among them that decide, by the kind in
their docstring (``benchmarks.pages.constants``); comparisons with the name of an effect or a block; and
functions of a cyclomatic complexity above 15 (McCabe 1976). A new effect does not count: the folders that
describe effects, ``EFFECTS``, are left out of all counts but the last. ``make check`` and ``.ci/run`` fail
above a limit.
"""

import ast
import io
import sys
import tokenize
from collections.abc import Iterator
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
    ROOM / "judge" / "weights.py",
    ROOM / "inference",
)
"""Folders that describe effects, by their table and their equations; the weights of ``make judge``; and the
engine of evidence, which stands next to the rules until it takes their place and has ``ENGINE`` limits."""
ENGINE = {"lines of code": 1000, "constants that decide": 5}
"""Upper bound of each count of the engine of evidence."""
NAMES = frozenset(CATALOGUE) | frozenset(BLOCKS_OF_EFFECTS) | {"attitude_sensor"}
LIMITS = {
    "lines of code": 6970,
    "constants": 212,
    "constants that decide": 55,
    "names compared": 15,
    "complex functions": 0,
}
"""Upper bound of each count. Lines have 2 % to spare, so that a mend needs no cut elsewhere. The evidence and
the judge brought 500 of them."""
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
    apart = _of_the_engine()
    for name, count in apart.items():
        above = "  ABOVE" if count > ENGINE[name] else ""
        print(f"engine: {name:22s}{count:7d}  limit {ENGINE[name]}{above}")
    too_large = any(count > ENGINE[name] for name, count in apart.items())
    return int(too_large or any(count > LIMITS[name] for name, count in counts.items()))


def _of_the_engine() -> dict[str, int]:
    """Return the counts of the engine of evidence, by the names of ``ENGINE``."""
    found = dict.fromkeys(ENGINE, 0)
    for path in sorted((ROOM / "inference").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        found["lines of code"] += len(_lines_of_code(text, tree))
        decides = [row for row in rows_in(tree) if row.kind == DECIDES]
        found["constants that decide"] += sum(len(row.values) for row in decides)
    return found


def counted() -> dict[str, int]:
    """All counts, by the names of ``LIMITS``."""
    found = dict.fromkeys(LIMITS, 0)
    for path in sorted(ROOM.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        found["complex functions"] += sum(_complexity(f) > MOST_COMPLEX for f in _functions(tree))
        if not any(path.is_relative_to(folder) for folder in EFFECTS):
            found["lines of code"] += len(_lines_of_code(text, tree))
            rows = list(rows_in(tree))
            found["constants"] += sum(len(row.values) for row in rows)
            found["constants that decide"] += sum(len(row.values) for row in rows if row.kind == DECIDES)
            found["names compared"] += sum(map(_compares_a_name, ast.walk(tree)))
    return found


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
