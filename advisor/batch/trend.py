"""The change test over flights: each flight's joint estimate against the earlier and the later ones."""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.decision.change import Change, find_change
from advisor.decision.history import CandidateManeuver
from advisor.oem.estimate import Estimate


@dataclass(frozen=True, slots=True)
class ChangeOverFlights:
    """A change between two flights of one aircraft."""

    since: int
    """Number of the first flight after the change."""
    change: Change
    """Change, whose numbers count the compared flights."""
    sentence: str


def change_over_flights(flights: Sequence[tuple[int, Estimate]]) -> ChangeOverFlights | None:
    """Return the most significant change over the flights of one aircraft; None when noise explains all
    differences.

    Parameters
    ----------
    flights
        Number and joint estimate of each flight, in the order of flying.
    """
    change = find_change([CandidateManeuver(estimate) for _, estimate in flights])
    if change is None:
        return None
    since = flights[change.after][0]
    moved = ", ".join(
        f"{one.parameter} is {abs(one.percent):.0f} % {'larger' if one.percent > 0.0 else 'smaller'}"
        for one in change.moved
    )
    cause = f"; it looks like {change.looks_like}" if change.looks_like else ""
    doubt = "" if change.confirmed else "; only one flight shows the change"
    return ChangeOverFlights(since, change, f"Since flight {since} {moved}{cause}{doubt}.")
