"""Errors that a user may meet: what is wrong, and the remedy."""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.words.ascii_output import printable


@dataclass(frozen=True)
class Problem:
    """One obstacle to the use of an input, as listed in the JSON documents."""

    code: str
    """Short and stable identifier: ``no_vehicle``, ``no_elevator``, ``rate``, ``not_a_tlog``, ``empty``,
    ..."""
    text: str
    """One sentence that says what is wrong, with the numbers."""
    fix: str
    """One sentence that says how to remedy the problem."""

    def __post_init__(self) -> None:
        # These sentences hold names of files and texts from vehicles.
        object.__setattr__(self, "text", printable(self.text))
        object.__setattr__(self, "fix", printable(self.fix))

    def __str__(self) -> str:
        return f"{self.text} {self.fix}".strip()

    def about(self, name: str) -> str:
        """Return the problem with ``name`` before its text, unless the text already contains ``name``."""
        name = printable(name)
        return str(self) if name in self.text else f"{name}: {self}"


class UnusableInputError(Exception):
    """The input cannot be used for this purpose (exit code 3)."""

    def __init__(self, code: str, text: str, fix: str = "", further: Sequence[Problem] = ()) -> None:
        self.problem = Problem(code, text, fix)
        self.problems = (self.problem, *further)
        """All problems of the input."""
        super().__init__("\n".join(map(str, self.problems)))

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> "UnusableInputError":
        """Return the error that lists at least one problem."""
        first, *further = problems
        return cls(first.code, first.text, first.fix, further)

    def __reduce__(self) -> tuple[type["UnusableInputError"], tuple[str, str, str, tuple[Problem, ...]]]:
        first, *further = self.problems
        return type(self), (first.code, first.text, first.fix, tuple(further))


class ConfigurationError(Exception):
    """The user's call or file is wrong (exit code 2); the message lists every mistake."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))
