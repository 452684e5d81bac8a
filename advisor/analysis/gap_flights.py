"""From logs to the manoeuvres of a diagnosis: each once, on one clock, without refused ones."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.state import NOTHING, ByHand, on_all
from advisor.decision.axes.requirements import needed, pitch_limits
from advisor.decision.envelope import changed_speed, incomplete, short_response
from advisor.decision.first_unit import natural_period
from advisor.decision.quality import refusals
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import (
    READER_NOTICE,
    FlightEvent,
    Maneuver,
    ManeuverAgain,
    ManeuverFlown,
    Notice,
    SideManeuverFlown,
)
from advisor.flight.stream.flights import Flights
from advisor.oem.estimate import NoEstimate
from advisor.simulators.air import SpeedKind
from advisor.words.problems import UnusableInputError, printable

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


_KNOWN = frozenset({"throttle", "rate"})
"""Reasons for a refusal that do not apply to the gap. The gap's model includes the throttle, and the gap
itself reports the effects that a slow channel hides."""
_LARGEST_SPEED_CHANGE_PERCENT = 30.0
"""Change of the air speed, %, up to which the gap scales forces with the speed, if the crew allows less.
Such a speed change alters the forces by two thirds. Manoeuvres of the generators stay below 24 %, and those
of two UAV records outside the model have 66 and 69 %."""
LEAST = 3
"""Least number of remaining manoeuvres: two for a search, and one for its check."""


@dataclass(frozen=True)
class Chosen:
    """The manoeuvres that the gap uses, and a sentence on each refused manoeuvre."""

    maneuvers: list[Maneuver]
    notes: tuple[str, ...]
    although_refused: tuple[int, ...] = ()
    """Numbers of the used manoeuvres that ``advisor analyze`` refuses."""

    def with_speed(self, kind: SpeedKind) -> "Chosen":
        """Return the choice with the kind of air speed that the motion shows."""
        return replace(self, maneuvers=kind.maneuvers, notes=(*filter(None, [kind.note]), *self.notes))


def without_refused(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Chosen:
    """Return the manoeuvres without those that exceed the limits or have incomplete data.

    If fewer than ``LEAST`` would remain, all are used, and the sentences name the defects.

    Raises
    ------
    UnusableInputError
        A contradicted instrument or the air speed leaves no manoeuvre.
    """
    reasons = {m.number: reason for m in maneuvers if (reason := _reason(m, aircraft)) is not None}
    good = [m for m in maneuvers if m.number not in reasons]
    hopeless = [r for r in reasons.values() if r.by_instrument or r.code == "airspeed"]
    if maneuvers and len(hopeless) == len(maneuvers):
        raise UnusableInputError(
            hopeless[0].code,
            f"No manoeuvre of the log can be used. Manoeuvre {maneuvers[0].number}: {hopeless[0].text}.",
            "Fly manoeuvres that advisor analyze accepts.",
        )
    if len(good) >= LEAST:
        return Chosen(good, tuple(f"Manoeuvre {n} is not used: {r.text}." for n, r in reasons.items()))
    notes = tuple(f"advisor analyze refuses manoeuvre {n}: {r.text}." for n, r in reasons.items())
    return Chosen(list(maneuvers), notes, tuple(reasons))


def _reason(maneuver: Maneuver, aircraft: Aircraft) -> Reason | None:
    """Return the first reason to refuse a manoeuvre in ``analyze``, independent of its estimate."""
    period_s = natural_period(maneuver, NoEstimate("not_asked", "no estimate was asked for"))
    most = max(aircraft.limits.airspeed_change_percent, _LARGEST_SPEED_CHANGE_PERCENT)
    allowing = replace(aircraft, limits=replace(aircraft.limits, airspeed_change_percent=most))
    reasons = [
        *incomplete(maneuver, needed("pitch", maneuver), period_s, ("alpha",)),
        # The gap has late streams and the scale of the air speed in its own model.
        *refusals(f for f in maneuver.findings if f.quantity != "delay_s" and f.channel != "airspeed"),
        *pitch_limits(maneuver, aircraft),
        *changed_speed(maneuver, allowing),
        *(r for r in short_response(maneuver, period_s) if r.code == "aborted"),
    ]
    return next((reason for reason in reasons if reason.code not in _KNOWN), None)
