"""From logs to the gap of the lateral axis, over the accepted manoeuvres of aileron and rudder."""

from collections.abc import Sequence
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.whole_flights import read_whole
from advisor.flight.maneuvers.marks import Mark
from advisor.gap.judge.prior import FIELD, FieldPrior
from advisor.oem.estimate import NoEstimate
from advisor.side_gap.comparison import SideGap, compare_side
from advisor.words.problems import Problem, UnusableInputError


def side_gap_of(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    marks: Sequence[Mark] = (),
    no_marks: bool = False,
    prior: FieldPrior = FIELD,
) -> SideGap:
    """Read logs and compare roll and yaw of the aircraft file with the flight.

    Raises
    ------
    UnusableInputError
        No log can be used, or no manoeuvre of aileron or rudder is accepted.
    """
    flights = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks, axis="lateral")
    state = flights.state.lateral
    assert state is not None
    accepted = [one.maneuver for one in state.maneuvers if one.verdict.accepted]
    if not accepted:
        raise UnusableInputError.of(
            [
                Problem(
                    "no_accepted",
                    "No manoeuvre of the aileron or the rudder is accepted.",
                    "advisor analyze --axis lateral gives the reason for each of them.",
                )
            ]
        )
    found = compare_side(accepted, aircraft, prior)
    if isinstance(found, NoEstimate):
        raise UnusableInputError.of(
            [Problem(found.code, found.text, "Fly an aileron doublet and a rudder doublet.")]
        )
    return found
