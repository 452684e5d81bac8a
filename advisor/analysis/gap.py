"""From logs to the gap between the flight and the aircraft file's simulator, or the file's model.

X-Plane, Simulink, FlightGear's generic protocol and test aircraft write tables. Their columns become messages
of a telemetry link, so that one code finds the manoeuvres of every log.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft, Alpha, Elevator, Estimation, TableColumns
from advisor.analysis.gap_flights import GapFlights, maneuvers_of, without_refused
from advisor.campaign.state import ByHand
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown
from advisor.flight.stream.stream import FlightStream
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.mavlink.logs.formats.table import SURFACES, messages_of, quantities_of, read_table, with_outputs
from advisor.mavlink.logs.kinds import recognised
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate_jointly
from advisor.simulators.air import by_the_motion
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.compare import Compared, agreeing, compare, compare_to_file
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Progress, Simulator
from advisor.simulators.specification import simulator_of
from advisor.words.problems import ConfigurationError, UnusableInputError

SUFFIXES = (".csv", ".txt", ".tsv", ".mat")


def table_maneuvers(path: Path, aircraft: Aircraft) -> list[Maneuver]:
    """Return the manoeuvres in a simulator's table. The elevator is the simulator's own.

    Raises
    ------
    ConfigurationError
        The aircraft file names a column that the table lacks.
    UnusableInputError
        The file is no table of numbers, its time does not rise, or no manoeuvre can be found.
    """
    given = quantities_of(read_table(path), aircraft.columns or TableColumns(), path.name)
    stream = FlightStream(with_outputs(replace(aircraft, elevator=Elevator(), alpha=Alpha())))
    events = [*stream.feed(list(messages_of(given, as_stamped=False))), *stream.finish()]
    if problems := stream.problems():
        raise UnusableInputError.of(problems)
    return [event.maneuver for event in events if isinstance(event, ManeuverFlown)]


def as_in_tables(aircraft: Aircraft, logs: Sequence[Path]) -> Aircraft:
    """Return the aircraft with the tables' surfaces, if the logs are tables; else the unchanged aircraft.

    A log that cannot be read changes nothing, because its reader gives the reason.

    Raises
    ------
    ConfigurationError
        Some logs are tables and some are not, or the aircraft file names a column that a table lacks.
    """
    surfaces = [_surfaces_in(log, aircraft.columns or TableColumns()) for log in logs]
    tables = [surface for surface in surfaces if surface is not None]
    if not tables:
        return aircraft
    if len(tables) < len(logs):
        raise ConfigurationError(
            "Some logs are tables of deflections and some carry servo outputs: analyze them in two commands."
        )
    return with_outputs(aircraft, tuple(name for name in SURFACES if any(name in table for table in tables)))


def _surfaces_in(log: Path, columns: TableColumns) -> frozenset[str] | None:
    """Return the surfaces in a table; None for another or an unreadable log."""
    try:
        beginning = beginning_of(log)
        with unpacked(log, beginning) as file:
            kind = recognised(beginning if file is log else beginning_of(file))
            if kind is None or kind.format.read_columns is None:
                return None
            return frozenset(SURFACES).intersection(quantities_of(read_table(file), columns, log.name))
    except UnusableInputError:
        return None


_WITHOUT_STRUCTURE = "Leave out --fix and --term, or log the signal."


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
        compared = compare_to_file(chosen.maneuvers, at_true_speed, holdout, progress, prior)
        compared = replace(compared, aircraft=aircraft)
    notes = [*chosen.notes, *flown.notes]
    if flown.again:
        every = len(flown.maneuvers) + flown.again
        twice = f"{flown.again} of {every} manoeuvres are recorded twice, for example in a copy of a log"
        notes.insert(0, f"{twice}: they count once.")
    progress("estimating with held parameters and added terms", 0.98)
    structured = _structured(chosen.maneuvers, aircraft)
    diagnosis = replace(
        compared.diagnosis, notes=(*notes, *compared.diagnosis.notes), structured=structured,
        air=replace(air, excess=compared.diagnosis.airspeed_excess), although_refused=chosen.although_refused,
    )  # fmt: skip
    return replace(compared, diagnosis=diagnosis)


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
