"""How large the gap diagnosis is, and that no count of it grows.

    python -m benchmarks.gap_size

Counted over ``advisor/gap`` are its lines of code, without docstrings, comments and blank lines, so that an
explanation costs nothing; its constants, which are names of numbers, outside the table of effects;
comparisons with the name of an effect or a block outside that table; and functions of a cyclomatic complexity
above 15 (McCabe 1976). ``LIMITS`` holds what the tree has. A limit falls, never rises: ``make check`` fails
above one, and below one too, until the limit is lowered.
"""

import ast
import io
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

from advisor.gap.candidates.traits import TRAITS
from benchmarks.pages.constants import constants_in

ROOM = Path(__file__).parents[1] / "advisor" / "gap"
TABLE = ROOM / "candidates"
"""Where names of effects belong."""
BLOCKS = frozenset(trait.block for trait in TRAITS.values()) | {"attitude_sensor"}
NAMES = frozenset(TRAITS) | BLOCKS
LIMITS = {"lines of code": 7493, "constants": 340, "names compared": 20, "complex functions": 0}
MOST_COMPLEX = 15
_LAYOUT = frozenset(
    {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
)
_BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.ExceptHandler, ast.comprehension, ast.match_case)


def main() -> int:
    """Print every count beside its limit; 1 where one is not what the limit says."""
    counts = counted()
    for name, count in counts.items():
        limit = LIMITS[name]
        verdict = "" if count == limit else "  ABOVE" if count > limit else f"  lower the limit to {count}"
        print(f"{name:18s}{count:7d}  limit {limit}{verdict}")
    return int(counts != LIMITS)


def counted() -> dict[str, int]:
    """All counts, by the names of ``LIMITS``."""
    found = dict.fromkeys(LIMITS, 0)
    for path in sorted(ROOM.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        found["lines of code"] += len(_lines_of_code(text, tree))
        found["complex functions"] += sum(_complexity(f) > MOST_COMPLEX for f in _functions(tree))
        if not path.is_relative_to(TABLE):
            found["constants"] += sum(len(constant.names) for constant in constants_in(tree))
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
