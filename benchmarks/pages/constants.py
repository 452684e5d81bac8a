"""The constants of a module, read from its source: names, values, the docstring below them, and their kind.

The first word of a docstring, before a colon, states the kind. A constant without a stated kind decides: a
comparison with it changes what is found, kept, named or said.
"""

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

_ARITHMETIC = frozenset({"dict", "zip"})
"""Functions whose result is as plain a number as their arguments; numpy's are called by attribute."""

KINDS = {
    "Numerical": "step, tolerance or extent of a computation",
    "Prior": "stated spread, bound or probability of an instrument, an aircraft or the air",
    "Record": "what a log must hold to be used at all",
    "Words": "what a text or a picture shows of an answer",
}
"""Kinds of constants that decide nothing, each with its meaning."""
DECIDES, DESCRIBES = "decides", "describes"
"""Kind of all other plain numbers; and kind of what is no plain number, the description of an effect."""


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


@dataclass(frozen=True)
class Row:
    """Constants that one docstring explains."""

    values: tuple[tuple[str, str], ...]
    meaning: str
    """Docstring without the kind."""
    kind: str
    """One of ``KINDS``, ``DECIDES`` or ``DESCRIBES``."""


def rows_in(tree: ast.Module) -> Iterator[Row]:
    """Yield the constants of a module; neighbours without a docstring share the next one's."""
    waiting: list[Constant] = []
    for constant in constants_in(tree):
        apart = waiting and waiting[-1].line + 1 != constant.begins
        if apart or (waiting and waiting[-1].is_plain != constant.is_plain):
            yield _row(waiting)
            waiting = []
        waiting.append(constant)
        if constant.meaning:
            yield _row(waiting)
            waiting = []
    if waiting:
        yield _row(waiting)


def _row(constants: Sequence[Constant]) -> Row:
    last = constants[-1]
    values = tuple(value for constant in constants for value in constant.values)
    stated, colon, rest = last.meaning.partition(": ")
    if not last.is_plain:
        return Row(values, last.meaning, DESCRIBES)
    if not colon or stated not in KINDS:
        return Row(values, last.meaning, DECIDES)
    return Row(values, rest[0].upper() + rest[1:], stated)


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
