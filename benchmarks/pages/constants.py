"""The constants of a module, read from its source: names, values, and the docstring below them."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass

_ARITHMETIC = frozenset({"dict", "zip"})
"""Functions whose result is as plain a number as their arguments; numpy's are called by attribute."""


@dataclass(frozen=True)
class Constant:
    """One assignment of numbers to names in capitals, at the top of a module."""

    values: tuple[tuple[str, str], ...]
    """Each name with its value as the source spells it."""
    meaning: str
    """The docstring below; empty without one."""
    line: int
    """Where the docstring ends, or else the assignment: the next statement begins after it."""
    begins: int
    is_plain: bool
    """Whether the value is made of numbers alone: no index of an array, no description of an effect."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names in capitals."""
        return tuple(name for name, _ in self.values)


def constants_in(tree: ast.Module) -> Iterator[Constant]:
    """Yield the constants of a module in their order."""
    for number, node in enumerate(tree.body):
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        if not any(map(_is_number, ast.walk(node.value))):
            continue
        below = tree.body[number + 1] if number + 1 < len(tree.body) else None
        meaning = _docstring(below)
        end = below.end_lineno if below is not None and meaning else node.end_lineno
        values = tuple(_values(node, node.value))
        if values:
            yield Constant(values, meaning, end or 0, node.lineno, _is_plain(node.value))


def _values(node: ast.Assign | ast.AnnAssign, value: ast.expr) -> Iterator[tuple[str, str]]:
    for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
        several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
        parts = zip(target.elts, value.elts, strict=True) if several else [(target, value)]
        for part, own in parts:
            for name in ast.walk(part):
                if isinstance(name, ast.Name) and name.id.isupper():
                    yield name.id, ast.unparse(own)


def _docstring(node: ast.stmt | None) -> str:
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return " ".join(node.value.value.split()) if is_text and isinstance(node.value.value, str) else ""


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _is_plain(value: ast.expr) -> bool:
    parts = list(ast.walk(value))
    called = (node.func for node in parts if isinstance(node, ast.Call))
    known = (
        isinstance(f, ast.Attribute) or (isinstance(f, ast.Name) and f.id in _ARITHMETIC) for f in called
    )
    return all(known) and not any(isinstance(node, ast.Subscript) for node in parts)
