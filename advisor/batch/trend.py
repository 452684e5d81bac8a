"""Change test over flights: each flight's joint estimate against those of earlier and later flights."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.change import Change, find_change
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES, posteriors_at_one_speed
from advisor.oem.estimate import Estimate
from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol


@dataclass(frozen=True, slots=True)
class ChangeOverFlights:
    """A change between two flights of one aircraft."""

    since: int
    """Number of the first flight after the change."""
    change: Change
    """Change between the compared flights, whose numbers count from the first flight."""
    sentence: str


def change_over_flights(flights: Sequence[tuple[int, Estimate]]) -> ChangeOverFlights | None:
    """Return the most significant change over the flights of one aircraft; None if noise explains all
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
        f"{symbol(m.parameter)} is {abs(m.percent):.0f} % {'larger' if m.percent > 0.0 else 'smaller'}"
        for m in change.moved
    )
    cause = f"; it looks like {change.looks_like}" if change.looks_like else ""
    doubt = "" if change.confirmed else "; only one flight shows the change"
    return ChangeOverFlights(since, change, f"Since flight {since} {moved}{cause}{doubt}.")


def lying_apart(flights: Sequence[tuple[int, Estimate]]) -> str:
    """Return a sentence on the two flights whose 95 % intervals of one derivative lie farthest apart; empty
    where all intervals of every derivative overlap.

    Parameters
    ----------
    flights
        Number and joint estimate of each flight, in the order of flying.
    """
    posteriors = posteriors_at_one_speed([estimate for _, estimate in flights])
    farthest, sentence = 1.0, ""
    for (i, first), (j, second) in combinations(enumerate(posteriors), 2):
        for k in DERIVATIVES:
            widths = NORMAL_95 * (first.std[k] + second.std[k])
            distance = abs(float(first.theta[k] - second.theta[k]))
            if distance > farthest * widths:
                farthest = distance / widths
                values = " and ".join(
                    with_half(float(p.theta[k]), NORMAL_95 * float(p.std[k])) for p in (first, second)
                )
                numbers = f"{flights[i][0]} and {flights[j][0]}"
                sentence = f"{symbol(PARAMETERS[k])} of flights {numbers} lies apart: {values}."
    return sentence
