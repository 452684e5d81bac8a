"""What goes wrong and how to mend it: the two errors a user may meet."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One obstacle, as the JSON documents list it."""

    code: str
    """Short and stable: ``no_vehicle``, ``no_elevator``, ``rate``, ``not_a_tlog``, ``empty``, ..."""
    text: str
    """What is wrong, one sentence with the numbers."""
    fix: str
    """How to mend it, one sentence."""

    def __str__(self) -> str:
        return f"{self.text} {self.fix}".strip()

    def about(self, name: str) -> str:
        """The sentence with what it is about before it, where it does not say so itself."""
        return str(self) if self.text.startswith(name) else f"{name}: {self}"


class UnusableInputError(Exception):
    """The input cannot serve this purpose (exit code 3)."""

    def __init__(self, code: str, text: str, fix: str = "") -> None:
        self.problem = Problem(code, text, fix)
        super().__init__(str(self.problem))

    def __reduce__(self) -> tuple[type["UnusableInputError"], tuple[str, str, str]]:
        return type(self), (self.problem.code, self.problem.text, self.problem.fix)


class ConfigurationError(Exception):
    """The user's call or file is wrong (exit code 2); the message lists every mistake."""
