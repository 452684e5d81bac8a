"""One flight, many answers: the process forks where a rule speaks, and the child goes on without the rule.

The parent waits for each child. Everything before the rule is computed once, and one process computes at a
time.
"""

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

_LONGEST_S = 60.0
"""CPU time of a child: a rule that ends a search may be what ends it at all."""


class Forks:
    """The forks of one case."""

    def __init__(self, case: str, closed: Callable[[str], bool], out: Path) -> None:
        self.case, self.closed, self.out = case, closed, out
        self.ablated: str | None = None
        self.spoke: set[str] = set()

    def heard(self, rule: str, said: Any, otherwise: Any) -> Any:
        """Return what a rule says, or, in the child without the rule, what stands there otherwise.

        Parameters
        ----------
        rule
            The rule's name.
        said, otherwise
            The rule's answer, and the answer of a diagnosis without the rule.
        """
        if rule == self.ablated:
            return otherwise
        if self.ablated is not None or rule in self.spoke:
            return said
        self.spoke.add(rule)
        if self.closed(rule):
            return said
        child = os.fork()
        if child:
            os.waitpid(child, 0)
            return said
        signal.setitimer(signal.ITIMER_VIRTUAL, _LONGEST_S)
        self.ablated = rule
        return otherwise

    def run(self, answer: Callable[[], dict[str, Any]]) -> None:
        """Answer the case, once with every rule and once without each rule that spoke; end the process."""
        try:
            found = answer()
        except Exception as error:  # A diagnosis without a rule may fail: that is its answer.
            found = {"failed": f"{type(error).__name__}: {error}"}
        line: dict[str, Any] = {"case": self.case, "without": self.ablated, "answer": found}
        if self.ablated is None:
            line["spoke"] = sorted(self.spoke)
        with self.out.open("a", encoding="utf-8") as out:
            out.write(json.dumps(line) + "\n")
        os._exit(0)
