"""Content of the page of ``advisor report``: the campaign of all logs, the examined telemetry,
and the gap.
"""

import platform
import shlex
import sys
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from math import inf
from pathlib import Path

from advisor import __version__
from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.axis_flown import compare_side_flown
from advisor.analysis.marks_file import SINCE_1970_S, began_s
from advisor.analysis.vibration import FieldSum, Vibration, vibration_of
from advisor.analysis.whole_flights import WholeFlights, holds_no_test, read_whole
from advisor.cli.doctor import examine_log
from advisor.cli.options import LogsAsked
from advisor.doctor.text import doctor_document
from advisor.exports.flights.reading import sha256
from advisor.gap.inference.engine import Progress
from advisor.report.document import analysis_document
from advisor.report.page.blocks import Content, Document, Origin
from advisor.session.diagnosis import diagnosed, document_of
from advisor.words.problems import UnusableInputError, printable

_COUNTED = ("numpy", "scipy", "matplotlib", "jinja2", "pymavlink")
"""Libraries on which numbers and pictures depend. The page lists their versions."""


def gather(
    asked: LogsAsked,
    aircraft: Aircraft,
    with_gap: bool,
    tell: Progress = lambda *_: None,
    command: str | None = None,
    fields: Mapping[Path, tuple[FieldSum, ...]] | None = None,
) -> tuple[Content, list[str]]:
    """Return the content of the page, and sentences on logs that do not count.

    Parameters
    ----------
    command
        Command line that repeats the page; None for the command line of this process.

    fields
        Fields that are asked for by name, by the path of the log.

    Raises
    ------
    UnusableInputError
        No log can be used.
    ConfigurationError
        As :func:`advisor.analysis.marks_file.read_by_hand`.
    """
    tell("reading and judging", 0.0)
    flights = read_whole(
        asked.logs, aircraft, asked.target_system, no_marks=asked.no_marks, axis="both", untested=True
    )
    said = flights.said
    tell("examining the telemetry", 0.5)
    doctor = tuple(_examined(log, aircraft, asked.target_system) for log in flights.logs)
    content = Content(
        state=flights.state,
        analysis=analysis_document(
            flights.state, [str(log) for log in flights.logs], aircraft, flights.left_out, said
        ),
        names=tuple(map(printable, flights.names)),
        aircraft=aircraft,
        power_ons=flights.power_ons,
        doctor=doctor,
        gap=_gap(flights, aircraft, asked, tell)
        if with_gap and not holds_no_test(flights.left_out)
        else None,
        begun=tuple(map(_date, flights.logs)),
        fields=tuple((fields or {}).get(log, ()) for log in flights.logs),
        vibration=tuple(_vibration(log, aircraft) for log in flights.logs),
        origin=Origin(
            _hashes(flights, asked.aircraft_file),
            dict(_versions()),
            printable(command or shlex.join(["advisor", *sys.argv[1:]])),
        ),
    )
    return content, said


def _vibration(log: Path, aircraft: Aircraft) -> Vibration | None:
    try:
        return vibration_of(log, aircraft.columns)
    except UnusableInputError:
        return None


def _examined(log: Path, aircraft: Aircraft, target_system: int | None) -> Document:
    try:
        return doctor_document(examine_log(log, aircraft, target_system))
    except UnusableInputError as error:
        return doctor_document(None, error.problem)


def _gap(flights: WholeFlights, aircraft: Aircraft, asked: LogsAsked, tell: Progress) -> Document:
    """Return the diagnosis of pitch, or of roll and yaw if only these have accepted manoeuvres."""
    if flights.state.lateral_alone is not None:
        return document_of(
            "lateral", lambda: compare_side_flown(flights.state, aircraft, progress=tell).diagnosis
        )
    usable = [flight for flight in range(len(flights.logs)) if flight not in flights.left_out]
    logs = [flights.logs[flight] for flight in usable]
    decided = [flights.by_hand.on_flight(flight) for flight in usable]
    return diagnosed(logs, aircraft, decided, asked.aircraft_file, asked.reading, asked.target_system, tell)


def _date(log: Path) -> str:
    """Return the date and time at which a log began, or a sentence if the log has no date."""
    at_s = began_s(log)
    if not SINCE_1970_S <= at_s < inf:
        return "no date in the log"
    return f"{datetime.fromtimestamp(at_s, UTC):%Y-%m-%d %H:%M} UTC"


def _hashes(flights: WholeFlights, aircraft_file: Path | None) -> Mapping[str, str]:
    """Return the SHA-256 of every input file, by the file's name."""
    named = [*zip(flights.names, flights.logs, strict=True)]
    named += [(aircraft_file.name, aircraft_file)] if aircraft_file else []
    return {printable(name): sha256(path) for name, path in named if path.is_file()}


def _versions() -> Iterator[tuple[str, str]]:
    yield "inflight-advisor", __version__
    yield "Python", platform.python_version()
    yield from ((name, version(name)) for name in _COUNTED)
