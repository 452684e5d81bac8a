"""What goes wrong and how to mend it: the two errors a user may meet."""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.printable import printable


@dataclass(frozen=True)
class Problem:
    """One obstacle, as the JSON documents list it."""

    code: str
    """Short and stable: ``no_vehicle``, ``no_elevator``, ``rate``, ``not_a_tlog``, ``empty``, ..."""
    text: str
    """What is wrong, one sentence with the numbers."""
    fix: str
    """How to mend it, one sentence."""

    def __post_init__(self) -> None:
        # Names of files and what vehicles say stand in these sentences.
        object.__setattr__(self, "text", printable(self.text))
        object.__setattr__(self, "fix", printable(self.fix))

    def __str__(self) -> str:
        return f"{self.text} {self.fix}".strip()

    def about(self, name: str) -> str:
        """Return the sentence with what it is about before it, where it does not say so itself."""
        name = printable(name)
        return str(self) if name in self.text else f"{name}: {self}"


class UnusableInputError(Exception):
    """The input cannot serve this purpose (exit code 3)."""

    def __init__(self, code: str, text: str, fix: str = "", further: Sequence[Problem] = ()) -> None:
        self.problem = Problem(code, text, fix)
        self.problems = (self.problem, *further)
        """All that is wrong with it."""
        super().__init__("\n".join(map(str, self.problems)))

    @classmethod
    def of(cls, problems: Sequence[Problem]) -> "UnusableInputError":
        """Return the error that lists all of these, at least one."""
        first, *further = problems
        return cls(first.code, first.text, first.fix, further)

    def __reduce__(self) -> tuple[type["UnusableInputError"], tuple[str, str, str, tuple[Problem, ...]]]:
        first, *further = self.problems
        return type(self), (first.code, first.text, first.fix, tuple(further))


class ConfigurationError(Exception):
    """The user's call or file is wrong (exit code 2); the message lists every mistake."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))
