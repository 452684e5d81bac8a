"""A change that came while a manoeuvre was flown: no step between two manoeuvres describes that one.

Fuel is pumped, a load drops, somebody moves: nobody waits for the end of a record. The one in which it
happened fits neither what was before nor what was after, and would be told as a gust, or as something
unknown. Without it the others tell what changed.
"""

import numpy as np

from advisor.gap.records.flights import Flight
from advisor.gap.search.stage import added_in
from advisor.gap.verdict.evidence import Evidence

_STANDS_OUT = 3.0
"""What is left of such a manoeuvre, beside a usual one."""
_MOST = 0.5
"""Of a change that took its time, what must lie between the manoeuvres before and after."""
_TRIFLE = 0.2
"""Share of the largest gain in log likelihood below which a change is not worth a second explanation."""
_UNKNOWN = 2
"""Riddles that something without a name is worth: a second name is the better answer."""


def torn_by_a_change(e: Evidence) -> int | None:
    """Number of the manoeuvre in which a change may have come; None where nothing points to one.

    It is one beside or within a change that was named: the one with the gust or the one of which most is
    left, by far; never the first or the last, for nothing would be left to change from or to.
    """
    flights = e.problem.flights.flights
    if _explanations(e) < 2:
        return None
    left = np.mean(e.stages[-1].held_out.by_maneuver / e.floor**2, axis=1)
    changes = _changes(e)

    def beside(i: int) -> bool:
        earliest, latest = _end_s(flights[i - 1]), flights[i + 1].started_s
        return any(began <= latest and earliest <= ended for began, ended in changes)

    may_be = list(filter(beside, range(1, len(flights) - 1)))
    if e.air is not None and e.air.gust:
        return next((flights[i].number for i in may_be if flights[i].number == e.air.gust_number), None)
    torn = max(may_be, key=lambda i: float(left[i]), default=None)
    if torn is None or left[torn] < _STANDS_OUT * np.median(np.delete(left, torn)):
        return None
    return flights[torn].number


def is_told_without(e: Evidence, without: Evidence, number: int) -> bool:
    """Whether the others, by themselves, tell of a change mostly at this one, and leave less to explain.

    Where a gust passes through more than one of them, that was no change either.
    """
    if without.air is not None and without.air.gust:
        return False
    flights = without.problem.flights.flights
    earliest = max((_end_s(f) for f in flights if f.number < number), default=np.inf)
    latest = min((f.started_s for f in flights if f.number > number), default=-np.inf)

    def mostly_there(began: float, ended: float) -> bool:
        there = min(ended, latest) - max(began, earliest)
        return there >= _MOST * (ended - began)

    return any(mostly_there(*change) for change in _changes(without)) and _explanations(
        without
    ) < _explanations(e)


def _end_s(flight: Flight) -> float:
    return flight.started_s + flight.duration_s


def _changes(e: Evidence) -> list[tuple[float, float]]:
    """From when to when each change came that was named and is no trifle beside the others, s."""
    named = added_in(e.stages)
    least = _TRIFLE * max((judged.gain for judged in named), default=0.0)
    found = []
    for judged in named:
        if not judged.variant.comes_at_any_time or judged.gain < least:
            continue
        said = {**judged.variant.fixed, **dict(zip(judged.variant.names, judged.value, strict=True))}
        found.append((float(said["at_s"]), float(said["at_s"] + said.get("over_s", 0.0))))
    return found


def _explanations(e: Evidence) -> int:
    """How much it takes: names, a gust, something without a name."""
    named = len(added_in(e.stages))
    gust = e.air is not None and e.air.gust
    return named + gust + _UNKNOWN * (e.leftover is not None)
