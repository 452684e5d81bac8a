"""Tables with named columns (CSV, or MATLAB's MAT): of a flight, or of a simulator.

X-Plane, Simulink, FlightGear's generic protocol and test aircraft write tables. The columns become
messages of a telemetry link, so that one code finds the manoeuvres of every log.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft, TableColumns
from advisor.aircraft.controls import Elevator
from advisor.aircraft.sensors import Alpha
from advisor.flight.maneuvers.events import ManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.kinds import recognised
from advisor.mavlink.logs.tables.file import read_table
from advisor.mavlink.logs.tables.messages import SURFACES, messages_of, with_outputs
from advisor.mavlink.logs.tables.quantities import quantities_of
from advisor.mavlink.logs.unpack import beginning_of, unpacked
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
