"""One more term of an equation: its text, such as ``M:q*abs(q)``, its parts, and the expressions that are
allowed.

Python parses the text to a syntax tree, which is evaluated node by node and never executed. A coefficient
multiplies the expression, so a model with more terms stays linear in its parameters.
"""

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

EQUATIONS: Mapping[str, str] = {"Z": "α̇", "M": "q̇", "Y": "β̇", "L": "ṗ", "N": "ṙ"}
"""Letter of each equation, and the rate on the equation's left side."""
OF_PITCH = ("Z", "M")
"""Letters of the equations of the pitch axis, in the order of its states."""
SIGNALS: Mapping[str, str] = {
    "alpha": "alpha", "beta": "beta", "p": "p", "q": "q", "r": "r", "phi": "bank", "theta": "theta",
    "V": "airspeed", "delta_e": "elevator", "delta_a": "aileron", "delta_r": "rudder", "thrust": "throttle",
}  # fmt: skip
"""Channel of each name that an expression may contain."""
FROM_MEAN = frozenset({"alpha", "theta", "delta_e", "delta_a", "delta_r", "thrust"})
"""Names whose values are deviations from the channel's mean over the manoeuvres. The derivatives thus stay
slopes at the trim.
"""
FUNCTIONS = ("abs", "sin", "cos")
MOST_LETTERS = 100
"""Largest number of characters of a term."""
_LARGEST_POWER = 6
"""Largest absolute value of an exponent."""
_OPERATORS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: lambda a, b: a**b,
}


@dataclass(frozen=True)
class AddedTerm:
    """A term with its coefficient as one more parameter, in rad, m and s."""

    equation: str
    """Letter of ``EQUATIONS``."""
    expression: str

    @property
    def name(self) -> str:
        """Name of the coefficient, as the user wrote the term: ``M:q*abs(q)``."""
        return f"{self.equation}:{self.expression}"

    @property
    def is_of_pitch(self) -> bool:
        """Whether the equation belongs to the short period."""
        return self.equation in OF_PITCH

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of ``SIGNALS`` in the expression, each once."""
        names = (node.id for node in ast.walk(_tree(self.expression)) if isinstance(node, ast.Name))
        return tuple(dict.fromkeys(name for name in names if name in SIGNALS))

    def factor(self, values: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]]) -> Any:
        """Return the value of the expression.

        Parameters
        ----------
        values
            Value of each signal in the expression, by the signal's name.
        functions
            Functions of ``FUNCTIONS`` for values of this kind.
        """

        def of(node: ast.AST) -> Any:
            match node:
                case ast.Constant():
                    return node.value
                case ast.Name():
                    return values[node.id]
                case ast.Call(func=ast.Name(id=name), args=[inside]):
                    return functions[name](of(inside))
                case ast.UnaryOp(op=ast.USub(), operand=inside):
                    return -of(inside)
                case ast.UnaryOp(operand=inside):
                    return of(inside)
                case ast.BinOp(left=left, op=operator, right=right):
                    return _OPERATORS[type(operator)](of(left), of(right))
            raise ValueError(_unknown(node))

        return of(_tree(self.expression))


def parse_term(text: str) -> AddedTerm:
    """Read ``EQUATION:EXPRESSION``.

    Raises
    ------
    ValueError
        The text is no term; the message says what is wrong, with the next step.
    """
    equation, colon, expression = text.partition(":")
    term = AddedTerm(equation.strip(), "".join(expression.split()))
    if not colon or not term.expression:
        raise ValueError(f"{text!r} is no EQUATION:EXPRESSION; write for example M:q*abs(q)")
    if term.equation not in EQUATIONS:
        raise ValueError(f"{term.equation!r} is no equation; write one of {', '.join(EQUATIONS)}")
    if len(text) > MOST_LETTERS:
        raise ValueError(f"{text[:20]!r}… has {len(text)} letters; write at most {MOST_LETTERS}")
    try:
        tree = _tree(expression.strip())
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(f"{expression!r} is no expression; write for example q*abs(q)") from None
    _refuse(tree)
    if not term.signals:
        raise ValueError(f"{expression!r} names no signal; use one of {' '.join(SIGNALS)}")
    return term


def _tree(expression: str) -> ast.expr:
    return ast.parse(expression, mode="eval").body


def _refuse(node: ast.AST) -> None:
    """Raise ValueError with the name of the first part of an expression that is not allowed."""
    match node:
        case ast.Constant(value=bool() | complex() | str() | bytes() | None):
            raise ValueError(_unknown(node))
        case ast.Constant():
            inside: list[ast.AST] = []
        case ast.Name(id=name):
            if name not in SIGNALS:
                raise ValueError(f"{name!r} is no signal; use {' '.join(SIGNALS)}")
            inside = []
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]):
            if name not in FUNCTIONS:
                raise ValueError(f"{name!r} is no function of a term; use {' '.join(FUNCTIONS)}")
            inside = [argument]
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
            inside = [operand]
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            _refuse_power(right)
            inside = [left]
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            inside = [left, right]
        case _:
            raise ValueError(_unknown(node))
    for part in inside:
        _refuse(part)


def _refuse_power(node: ast.AST) -> None:
    """Raise ValueError unless the exponent is a small whole number."""
    number = node.operand if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) else node
    value = number.value if isinstance(number, ast.Constant) else None
    if type(value) is not int or not 1 <= value <= _LARGEST_POWER:
        raise ValueError(f"{ast.unparse(node)!r} is no exponent; use a whole number up to {_LARGEST_POWER}")


def _unknown(node: ast.AST) -> str:
    parts = f"+ - * / ** {' '.join(FUNCTIONS)} and {' '.join(SIGNALS)}"
    return f"{ast.unparse(node)!r} is not allowed; use {parts}"
