"""A failing case made smaller: fewer unkindnesses, then a shorter piece of the log."""

from collections.abc import Callable
from dataclasses import replace

from benchmarks.endure.cases import Case, Unkindness

HALVINGS = 6
"""Times that the piece of the log is halved: each costs two answers at most."""


def shrunk(case: Case, fails: Callable[[Case], bool]) -> Case:
    """Return a smaller case that fails as well.

    Parameters
    ----------
    fails
        Whether a case fails by the same kind.
    """
    at = 0
    while at < len(case.unkindnesses):
        fewer = case.without(at)
        if fails(fewer):
            case = fewer
        else:
            at += 1
    return _shorter(case, fails) if ".tlog" in case.log else case


def _shorter(case: Case, fails: Callable[[Case], bool]) -> Case:
    first = case.unkindnesses[:1]
    begin, end = map(float, first[0].words) if first and first[0].form == "cut" else (0.0, 1.0)
    rest = case.unkindnesses[1:] if first and first[0].form == "cut" else case.unkindnesses
    for _ in range(HALVINGS):
        middle = round((begin + end) / 2.0, 6)
        halves = ((begin, middle), (middle, end))
        tried = [replace(case, unkindnesses=(Unkindness("cut", half), *rest)) for half in halves]
        found = next((i for i, half in enumerate(tried) if fails(half)), None)
        if found is None:
            break
        case, (begin, end) = tried[found], halves[found]
    return case
