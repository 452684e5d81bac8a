"""The changes that a module's deciding lines allow, found in its syntax tree.

A line decides by a comparison, by a term of ``and`` or ``or``, or by a constant in capitals that some module
compares. A change is large enough to be seen: a number doubles or halves, a comparison turns round, a term
goes.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from benchmarks.pages.constants import DECIDES, rows_in

BOUNDS = frozenset({"min", "max", "clip", "minimum", "maximum"})
"""Functions that compare their arguments."""
_TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
_ORDER = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


@dataclass(frozen=True)
class Change:
    """One change of the text of a module, by the place of the changed expression."""

    line: int
    """Line on which the expression begins, from 1."""
    begin: int
    end: int
    """Places in the UTF-8 text, bytes: the expression begins at the first and ends before the second."""
    new: str

    def apply(self, text: str) -> str:
        """Return the text of the module with the new expression."""
        whole = text.encode()
        return (whole[: self.begin] + self.new.encode() + whole[self.end :]).decode()


def compared_names(tree: ast.Module) -> set[str]:
    """Return the names in capitals that a module compares with something."""
    found = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) or (isinstance(node, ast.Call) and _called(node) in BOUNDS):
            found.update(one.id for one in ast.walk(node) if isinstance(one, ast.Name) and one.id.isupper())
    return found


def changes_of(text: str, compared: set[str]) -> list[Change]:
    """Return all changes of a module.

    Parameters
    ----------
    text
        Source of the module.
    compared
        Names in capitals that some module compares.
    """
    tree = ast.parse(text)
    starts = [0]
    for line in text.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    found = [*_of_constants(tree, compared), *_of_decisions(tree)]
    return [
        Change(
            old.lineno,
            starts[old.lineno - 1] + old.col_offset,
            starts[(old.end_lineno or old.lineno) - 1] + (old.end_col_offset or 0),
            new,
        )
        for old, new in found
    ]


def _of_constants(tree: ast.Module, compared: set[str]) -> Iterator[tuple[ast.expr, str]]:
    kinds = {name: row.kind for row in rows_in(tree) for name, _ in row.values}
    for node in tree.body:
        match node:
            case (
                ast.Assign(targets=[ast.Name(id=name)], value=ast.expr() as value)
                | ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value)
            ) if name in compared and kinds.get(name) == DECIDES:
                yield from ((value, new) for new in _scaled(value))


def _of_decisions(tree: ast.Module) -> Iterator[tuple[ast.expr, str]]:
    ahead: list[ast.AST] = [tree]
    while ahead:
        node = ahead.pop()
        if isinstance(node, ast.Assert):
            continue
        ahead += ast.iter_child_nodes(node)
        if isinstance(node, ast.Compare):
            yield from _turned(node)
            for side in (node.left, *node.comparators):
                yield from ((number, new) for number in _numbers(side) for new in _scaled(number))
        elif isinstance(node, ast.BoolOp):
            yield from _shortened(node)


def _turned(node: ast.Compare) -> Iterator[tuple[ast.expr, str]]:
    sides = [node.left, *node.comparators]
    for number, operator in enumerate(node.ops):
        is_decided = isinstance(operator, _ORDER) or any(map(_is_limit, sides[number : number + 2]))
        if is_decided and type(operator) in _TURNED:
            turned = [*node.ops[:number], _TURNED[type(operator)](), *node.ops[number + 1 :]]
            yield node, ast.unparse(ast.Compare(node.left, turned, node.comparators))


def _shortened(node: ast.BoolOp) -> Iterator[tuple[ast.expr, str]]:
    for number in range(len(node.values)):
        left = [*node.values[:number], *node.values[number + 1 :]]
        yield node, f"({ast.unparse(left[0] if len(left) == 1 else ast.BoolOp(node.op, left))})"


def _numbers(side: ast.expr) -> Iterator[ast.Constant]:
    """Yield the numbers of the arithmetic of one side; an index or an argument of a function is none."""
    match side:
        case ast.Constant() if type(side.value) in (int, float):
            yield side
        case ast.BinOp():
            yield from _numbers(side.left)
            yield from _numbers(side.right)
        case ast.UnaryOp():
            yield from _numbers(side.operand)


def _scaled(value: ast.expr) -> Iterator[str]:
    old = ast.unparse(value)
    try:
        number = ast.literal_eval(value)
    except ValueError:
        number = 1.0 if _is_arithmetic(value) else None
    if type(number) is int:
        yield str(2 * number or 1)
        if number > 1:
            yield str(number // 2)
    elif type(number) is float and number != 0.0:
        yield f"(2.0 * {old})"
        yield f"(0.5 * {old})"


def _is_arithmetic(value: ast.expr) -> bool:
    return isinstance(value, ast.BinOp) or (
        isinstance(value, ast.Call) and _called(value) in {"radians", "deg2rad", "sqrt", "float", "log"}
    )


def _is_limit(side: ast.expr) -> bool:
    return bool(list(_numbers(side))) or (isinstance(side, ast.Name) and side.id.isupper())


def _called(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
