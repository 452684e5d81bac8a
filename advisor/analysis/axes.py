"""Axes of an analysis: which flights tell nothing of the axis that is asked for."""

from collections.abc import Mapping, Sequence
from typing import Literal

from advisor.campaign.state import OF_ELEVATOR, CampaignState
from advisor.flight.stream.flights import FlightHeard
from advisor.words.problems import Problem

Axis = Literal["pitch", "lateral", "both"]


def left_out_of(axis: Axis, state: CampaignState) -> dict[int, tuple[Problem, ...]]:
    """Return the flights that do not count, each with its problems.

    A flight with an accepted lateral manoeuvre needs none of the elevator's.
    """
    left_out = {one.flight: one.problems for one in state.flights if one.problems}
    if state.lateral is None:
        return left_out
    told = {
        one.maneuver.flight for one in state.lateral.maneuvers if axis == "lateral" or one.verdict.accepted
    }
    elsewhere = {
        flight: problems
        for flight, problems in left_out.items()
        if not all(p.code in OF_ELEVATOR for p in problems)
    }
    if axis == "lateral":
        silent = [one for one in state.flights if one.flight not in told and one.flight not in elsewhere]
        return elsewhere | {one.flight: (no_lateral(one),) for one in silent}
    return {flight: problems for flight, problems in left_out.items() if flight not in told} | elsewhere


def holds_no_test(left_out: Mapping[int, Sequence[Problem]]) -> bool:
    """Return whether the absence of test inputs is all that keeps these flights from counting."""
    return bool(left_out) and all(p.code in _UNTESTED for several in left_out.values() for p in several)


_UNTESTED = frozenset({"no_maneuver", "no_aileron"})
"""Codes of problems of a flight whose telemetry can serve, and which holds no test input."""


def no_lateral(flight: FlightHeard) -> Problem:
    """Return why a flight has no lateral manoeuvre."""
    if flight.sides_unknown is not None:
        return flight.sides_unknown
    return Problem(
        "no_maneuver",
        "No test manoeuvre of the aileron or the rudder was found.",
        "Fly an aileron doublet and a rudder doublet in MANUAL, hands and feet still before and after.",
    )
