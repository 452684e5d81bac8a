"""From logs to a diagnosis: every manoeuvre is used once, then ``advisor.gap`` diagnoses the gap."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft, Estimation
from advisor.analysis.log_series import LogSeries
from advisor.analysis.refused import without_refused
from advisor.analysis.table_log import SUFFIXES, table_maneuvers
from advisor.campaign.hand_decisions import NOTHING, ByHand, on_all
from advisor.flight.instruments.atmosphere import air_flown
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
from advisor.gap.diagnose import examine, without_simulator
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.search.baseline import prior_derivatives
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate_jointly
from advisor.simulators.agreed import agreeing
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.compare import Compared, compare
from advisor.simulators.flying import Progress
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Simulator
from advisor.simulators.specification import simulator_of
from advisor.simulators.speed_kind import by_the_motion
from advisor.simulators.static_errors import with_static_errors
from advisor.simulators.taken_back import with_unseen_shrink
from advisor.simulators.unseen import changes_something, unseen_of
from advisor.words.printable import printable
from advisor.words.problems import UnusableInputError

_PAUSE_S = 60.0
"""Assumed time between the last manoeuvre of one log and the first of the next, s. No clock measured the
pause between two logs."""


_WITHOUT_STRUCTURE = "Leave out --fix and --term, or log the signal."


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


def compare_logs(
    logs: Sequence[Path],
    aircraft: Aircraft,
    holdout: int | None = None,
    target_system: int | None = None,
    progress: Progress = lambda *_: None,
    by_hand: Sequence[ByHand] = (),
    prior: FieldPrior = FIELD,
    flown: GapFlights | None = None,
) -> Compared:
    """Read logs and diagnose their gap to the simulator that the aircraft file names, or to the file's model.

    Raises
    ------
    UnusableInputError
        A log cannot be read or cannot serve, or the simulator does not fly.
    """
    with opened_simulator(aircraft, target_system) as simulator:
        progress("reading", 0.0)
        flown = flown or maneuvers_of(logs, aircraft, target_system, by_hand)
        return compare_flown(flown, aircraft, simulator, holdout, progress, prior)


def compare_flown(
    flown: GapFlights,
    aircraft: Aircraft,
    simulator: Simulator | None,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
    prior: FieldPrior = FIELD,
) -> Compared:
    """Diagnose the gap of manoeuvres to a simulator, or to the aircraft file's model where there is none.

    Raises
    ------
    UnusableInputError
        The manoeuvres cannot be used, or the simulator does not fly.
    """
    chosen = without_refused(flown.maneuvers, aircraft)
    if simulator is not None and not isinstance(simulator, LinearSimulator):
        progress("comparing the air speed with the motion", 0.02)
        chosen = chosen.with_speed(by_the_motion(chosen.maneuvers, aircraft))
    air = air_flown(chosen.maneuvers, aircraft.reference.air_temperature_c)
    at_true_speed = with_true_reference(aircraft, air.true_over_read)
    if simulator is not None:
        as_true = _simulator_at_true_speed(simulator, air.true_over_read)
        compared = compare(chosen.maneuvers, as_true, at_true_speed, holdout, progress, prior)
        if not isinstance(simulator, LinearSimulator):
            logged = estimate_jointly(chosen.maneuvers, aircraft)
            compared = replace(compared, diagnosis=agreeing(compared.diagnosis, logged))
    else:
        whole = stays = examine(chosen.maneuvers, at_true_speed, holdout, progress, prior)
        diagnosis = whole.diagnosis
        if prior_derivatives(aircraft) is None:
            diagnosis = without_simulator(diagnosis, aircraft)
        elif changes_something(diagnosis):
            progress("measuring the gap's reduction on held-out manoeuvres", 0.9)
            unseen = unseen_of(whole, holdout)
            if unseen is not None:
                stays = with_unseen_shrink(whole, unseen, at_true_speed)
                diagnosis = stays.diagnosis
        diagnosis = with_static_errors(diagnosis, whole)
        compared = Compared(diagnosis, aircraft, stays.findings)
    notes = [*chosen.notes, *flown.notes]
    if flown.again:
        every = len(flown.maneuvers) + flown.again
        twice = f"{flown.again} of {every} manoeuvres are recorded twice, for example in a copy of a log"
        notes.insert(0, f"{twice}: they count once.")
    progress("estimating with held parameters and added terms", 0.98)
    structured = _structured(chosen.maneuvers, aircraft)
    every_note = (*notes, *compared.diagnosis.notes)
    air = replace(air, excess=compared.diagnosis.airspeed_excess)
    noted = replace(
        compared.diagnosis, notes=every_note, air=air, structured=structured,
        although_refused=chosen.although_refused,
    )  # fmt: skip
    return replace(compared, diagnosis=noted)


def _structured(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Estimate | None:
    """Return the estimate with the parameters that the user holds and the terms that the user adds; None
    without both."""
    if aircraft.estimation == Estimation():
        return None
    fitted = estimate_jointly(maneuvers, aircraft)
    if isinstance(fitted, NoEstimate):
        raise UnusableInputError(fitted.code, fitted.text, _WITHOUT_STRUCTURE)
    return fitted.structured


@contextmanager
def opened_simulator(aircraft: Aircraft, target_system: int | None = None) -> Iterator[Simulator | None]:
    """Open the simulator of :func:`named_simulator`, and close it at the end."""
    simulator = named_simulator(aircraft, target_system)
    try:
        yield simulator
    finally:
        if simulator is not None:
            simulator.close()


def named_simulator(aircraft: Aircraft, target_system: int | None = None) -> Simulator | None:
    """Open the simulator that the aircraft file names; None if the file names none.

    Raises
    ------
    ConfigurationError
        The specification of the simulator is unknown.
    UnusableInputError
        The log that a simulator wrote cannot be used.
    """
    if aircraft.simulator is None:
        return None

    def read(log: Path) -> list[Maneuver]:
        if log.suffix.lower() in SUFFIXES:
            return table_maneuvers(log, aircraft)
        return maneuvers_of([log], aircraft, target_system).maneuvers

    return simulator_of(aircraft.simulator, aircraft, read)


def with_true_reference(aircraft: Aircraft, true_over_read: float) -> Aircraft:
    """Return the aircraft with its reference speed, which is stated as the aircraft reads it, converted to
    the true air speed.
    """
    read = aircraft.reference_airspeed_m_s
    return aircraft if read is None else replace(aircraft, reference_airspeed_m_s=read * true_over_read)


def _simulator_at_true_speed(simulator: Simulator, true_over_read: float) -> Simulator:
    """Return the simulator at the true reference speed. ``linear`` has the aircraft file's."""
    if isinstance(simulator, IdentifiedSimulator) or not isinstance(simulator, LinearSimulator):
        return simulator
    read = simulator.reference_m_s
    return simulator if read is None else replace(simulator, reference_m_s=read * true_over_read)
