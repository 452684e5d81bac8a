"""The outcome of one drawn case."""

from typing import NamedTuple

from benchmarks.endure.cases import Case, draw
from benchmarks.endure.shrink import shrunk
from benchmarks.endure.trial import Failure, failure


class Outcome(NamedTuple):
    """A case, what is wrong with its answer, and the smallest case of the same kind."""

    case: Case
    found: Failure | None = None
    smallest: Case | None = None


def tried(seed: int, of: tuple[str, ...], number: int) -> Outcome:
    """Answer one drawn case, and make it smaller where it fails."""
    case = draw(seed, number, of)
    found = failure(case)
    if found is None or found.kind.startswith("too long"):
        return Outcome(case, found, case)

    def fails(other: Case) -> bool:
        again = failure(other)
        return again is not None and again.kind == found.kind

    return Outcome(case, found, shrunk(case, fails))
