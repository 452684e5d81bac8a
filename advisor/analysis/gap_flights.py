"""From logs to the manoeuvres of a diagnosis: every manoeuvre once, with times on one clock."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.log_series import LogSeries
from advisor.campaign.hand_decisions import NOTHING, ByHand, on_all
from advisor.flight.maneuvers.events import (
    READER_NOTICE,
    FlightEvent,
    ManeuverAgain,
    ManeuverFlown,
    Notice,
    SideManeuverFlown,
)
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.stream.flights import Flights
from advisor.words.printable import printable
from advisor.words.problems import UnusableInputError

_PAUSE_S = 60.0
"""Assumed time between the last manoeuvre of one log and the first of the next, s. No clock measured the
pause between two logs."""


@dataclass(frozen=True)
class GapFlights:
    """Manoeuvres of several logs, prepared for a diagnosis."""

    maneuvers: list[Maneuver]
    """Every manoeuvre once, with consecutive numbers and times on one clock."""
    again: int
    """Number of repeated manoeuvres that were omitted."""
    notes: tuple[str, ...]
    """Assumptions about the elevator, and the manoeuvres excluded by hand, as sentences."""
    lateral: bool = False
    """Whether the logs hold a manoeuvre of aileron or rudder, if these were looked for."""


def maneuvers_of(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    by_hand: Sequence[ByHand] = (),
    lateral: bool = False,
) -> GapFlights:
    """Read the manoeuvres of all logs, with the decisions by hand on each log.

    The logs are taken in the order of their times, as in a campaign. The clock begins with the first log's,
    and continues across other logs and restarts of the vehicle.

    Parameters
    ----------
    lateral
        Whether inputs of aileron and rudder are looked for, too.

    Raises
    ------
    UnusableInputError
        No log can be read, or a log cannot be used. A log that cannot be read is left out, with a note.
    """
    series = LogSeries(logs, aircraft.columns)
    decided = dict(zip(logs, by_hand or [NOTHING] * len(logs), strict=True))
    by_hand_on_all = on_all([decided[log] for log in series.logs])

    def begin() -> tuple[Flights, list[FlightEvent]]:
        return Flights(aircraft, target_system, by_hand_on_all.marks, series.names, lateral), []

    flights, events = series.fed_to(begin, lambda read, columns: read[1].extend(read[0].feed(columns)))
    events += flights.finish()
    names = [printable(log.name) for log in series.logs]
    notes = [series.order_said]
    notes += [f"Left out: {problem.about(names[k])}" for k, problem in series.unreadable.items()]
    if len(series.unreadable) == len(logs):
        raise UnusableInputError.of(list(series.unreadable.values()))
    heard = [x for x in flights.heard(flights.stream.channels, True) if x.flight not in series.unreadable]
    if wrong := [replace(p, text=f"{names[x.flight]}: {p.text}") for x in heard for p in x.problems]:
        raise UnusableInputError.of(wrong)
    notes += flights.elevator_notes
    notes += [e.text for e in events if isinstance(e, Notice) and e.code == READER_NOTICE]
    recorded: dict[int, Maneuver] = {}
    for event in events:
        if isinstance(event, ManeuverFlown) or (isinstance(event, ManeuverAgain) and event.takes_place):
            recorded[event.maneuver.number] = event.maneuver
    used: list[Maneuver] = []
    for maneuver in recorded.values():
        because = by_hand_on_all.excluded_because(maneuver)
        if because is not None:
            said = f"manoeuvre {maneuver.number} is excluded by hand: {because}."
            notes.append(f"{names[maneuver.flight]}: {said}")
        elif maneuver.flight not in series.unreadable:
            used.append(replace(maneuver, number=len(used) + 1))
    again = sum(x.again for x in heard)
    sideways = any(isinstance(event, SideManeuverFlown) for event in events)
    return GapFlights(_on_one_clock(used), again, tuple(dict.fromkeys(filter(None, notes))), sideways)


def _on_one_clock(maneuvers: Sequence[Maneuver]) -> list[Maneuver]:
    """Return the manoeuvres with continuous times, also after a restart of the vehicle's clock."""
    on_clock: list[Maneuver] = []
    ahead = 0.0
    for maneuver in maneuvers:
        if on_clock and maneuver.span.record_from_s + ahead < on_clock[-1].span.end_s:
            ahead = on_clock[-1].span.end_s + _PAUSE_S - maneuver.span.record_from_s
        on_clock.append(maneuver.later(ahead) if ahead else maneuver)
    return on_clock
