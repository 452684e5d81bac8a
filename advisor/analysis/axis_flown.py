"""Axes that a diagnosis of logs can judge: those with an accepted manoeuvre."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.axes.side_comparison import accepted_of
from advisor.analysis.gap_flights import GapFlights, maneuvers_of, without_refused
from advisor.analysis.whole_flights import Axis, read_whole
from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.events import SideManeuverFlown
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.whole import read_whole_log
from advisor.words.problems import UnusableInputError


class AxisFlown(NamedTuple):
    """Axes that a diagnosis of the logs can judge, with the data that were read for this choice."""

    axis: Axis
    elevator: GapFlights | None
    """Manoeuvres of the elevator, if they can be read."""
    state: CampaignState | None = None
    """State of the campaign with both axes, if roll and yaw have an accepted manoeuvre."""


def axis_flown(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    by_hand: Sequence[ByHand] = (),
    marks: Sequence[Mark] = (),
    no_marks: bool = False,
) -> AxisFlown:
    """Return the axes with an accepted manoeuvre, and the data that were read.

    Without an accepted manoeuvre, the axis is pitch.
    """
    flown = None
    is_pitch = sideways = False
    try:
        flown = maneuvers_of(logs, aircraft, target_system, by_hand, lateral=True)
        sideways = flown.lateral
        if sideways:
            # An input of all controls at once has other ends where roll and yaw are looked for.
            flown = maneuvers_of(logs, aircraft, target_system, by_hand)
        chosen = without_refused(flown.maneuvers, aircraft)
        is_pitch = len(chosen.although_refused) < len(chosen.maneuvers)
    except UnusableInputError:
        pass  # The diagnosis of pitch gives the reason, where roll and yaw have no manoeuvre either.
    try:
        if is_pitch and not sideways:
            return AxisFlown("pitch", flown)
        state = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks, axis="lateral").state
        accepted_of(state)
    except UnusableInputError:
        return AxisFlown("pitch", flown)
    return AxisFlown("both" if is_pitch else "lateral", flown, state)


def flies_roll_or_yaw(
    log: Path, aircraft: Aircraft, target_system: int | None, marks: Sequence[Mark]
) -> bool:
    """Return whether a log holds a manoeuvre of aileron or rudder, without an analysis of the campaign."""
    stream = FlightStream(aircraft, target_system, marks, lateral=True)
    events = [
        event for columns in read_whole_log(log, columns=aircraft.columns) for event in stream.feed(columns)
    ]
    return any(isinstance(event, SideManeuverFlown) for event in (*events, *stream.finish()))
