"""The ``advisor.expect/1`` document for scripts."""

from collections.abc import Sequence
from typing import Any

from advisor.expectations.check import Outcome
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem

SCHEMA = "advisor.expect/1"


def expect_document(
    log: str, file: str, outcomes: Sequence[Outcome], problems: Sequence[Problem] = ()
) -> dict[str, Any]:
    """Return the document of ``advisor expect --json``; an unusable log has problems and no outcomes."""
    return {
        "schema": SCHEMA,
        "usable": not problems,
        "problems": plain(problems),
        "log": log,
        "file": file,
        "holds": None if problems else all(outcome.holds for outcome in outcomes),
        "expectations": [picked(outcome, "name asked found holds") for outcome in outcomes],
    }
