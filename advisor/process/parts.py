"""Parts of an answer that may fail separately: a manoeuvre, an axis, an effect, a pane, a picture, an export.

A numerical fault inside a part becomes a value with the fault's reason. The rest of the answer remains valid,
and every display names the missing part.
"""

import os
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from advisor.words.problems import Problem

FAULTS = (np.linalg.LinAlgError, ZeroDivisionError, FloatingPointError, OverflowError, IndexError)
"""Numerical errors that end one part of an answer. Every other error is not numerical and ends the
program."""
INTERNAL = "internal"
"""Problem code of a part that failed by a fault of the advisor."""
_Made = TypeVar("_Made")


@dataclass(frozen=True, slots=True)
class FailedPart:
    """A part of an answer that a numerical fault of the advisor ended."""

    part: str
    """Name of the failed part, such as ``lateral, manoeuvre 3``."""
    reason: str
    """Type and message of the numerical fault."""
    trace: str = field(default="", compare=False, repr=False)
    """Traceback of the numerical fault."""

    @property
    def problem(self) -> Problem:
        """Sentence on the missing part, with the user's next step."""
        text = f"A fault of the advisor, not yours, ended this part: {self.part} ({self.reason})."
        fix = "The rest of the answer is valid. Set ADVISOR_TRACEBACK=1 to see where, and report this error."
        return Problem(INTERNAL, text, fix)

    @property
    def entry(self) -> dict[str, str]:
        """Entry of the failed part under ``problems`` in a JSON document."""
        problem = self.problem
        return {"code": problem.code, "part": self.part, "text": problem.text, "fix": problem.fix}

    @property
    def sentence(self) -> str:
        """Sentence for people, with the traceback if ``ADVISOR_TRACEBACK`` requests it."""
        wanted = self.trace and os.environ.get("ADVISOR_TRACEBACK")
        return f"{self.problem}\n{self.trace}" if wanted else str(self.problem)


def attempt(part: str, work: Callable[[], _Made]) -> _Made | FailedPart:
    """Return the result of ``work``, or the failed part if a numerical fault ended the work."""
    try:
        return work()
    except FAULTS as fault:
        return FailedPart(part, f"{type(fault).__name__}: {fault}", traceback.format_exc())


class Parts:
    """Computes the parts of one answer, and keeps a list of the failed parts."""

    def __init__(self, tell: Callable[[FailedPart], object] = lambda failed: None) -> None:
        self._tell = tell
        self._failed: dict[str, FailedPart] = {}

    @property
    def failed(self) -> tuple[FailedPart, ...]:
        """Parts whose newest attempt failed, in the order of their first failures."""
        return tuple(self._failed.values())

    def kept(self, part: str, work: Callable[[], _Made | None]) -> _Made | None:
        """Return the result of ``work``; None if a fault ends the part."""
        return self.make(part, work, lambda failed: None)

    def ended(self, part: str, reason: str) -> None:
        """Add a part that ended without a fault, but before its result was final."""
        failed = FailedPart(part, reason)
        self._tell(failed)
        self._failed[part] = failed

    def make(self, part: str, work: Callable[[], _Made], instead: Callable[[FailedPart], _Made]) -> _Made:
        """Return the result of ``work``, or the result of ``instead`` if a numerical fault ended the part."""
        made = attempt(part, work)
        if not isinstance(made, FailedPart):
            self._failed.pop(part, None)
            return made
        if part not in self._failed:
            self._tell(made)
        self._failed[part] = made
        return instead(made)
