"""The log of one manoeuvre: a tlog's packets around the manoeuvre, byte by byte, and the earlier packets that
reading needs.

The cut log is read again, to check that the log still contains the manoeuvre.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.whole_flights import WholeFlights
from advisor.flight.maneuvers.events import ManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver, are_one
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.formats.telemetry import FORMAT as TLOG
from advisor.mavlink.logs.kinds import recognised
from advisor.mavlink.logs.tlog import read_tlog
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.framing import CRC_EXTRA, LONGEST_FRAME, FrameCutter
from advisor.mavlink.wire.scan import STAMP_BYTES
from advisor.process.arrays import IntArray
from advisor.words.problems import ConfigurationError, UnusableInputError

BEFORE = {"HEARTBEAT": (), "AUTOPILOT_VERSION": (), "PARAM_VALUE": ("param_id",)}
"""Key fields of each message whose last value before the stretch is needed, by the message's name. These
messages give identity, mode and parameters of the vehicle."""


def cut_tlog(log: Path, first: int, last: int) -> bytes:
    """Return the packets of a tlog between two positions, after the newest earlier heartbeats and parameters.

    Parameters
    ----------
    log
        A tlog, packed or not.
    first, last
        Positions of the first and the last packet's frame in the unpacked log, bytes.

    Returns
    -------
    bytes
        Whole records of the log, unchanged: time stamp and frame.

    Raises
    ------
    ConfigurationError
        The log is no tlog.
    """
    beginning = beginning_of(log)
    with unpacked(log, beginning) as plain:
        kind = recognised(beginning_of(plain) if plain is not log else beginning)
        if kind is None or kind.format is not TLOG:
            raise ConfigurationError(
                f"--cut: {log} is no tlog, and only tlogs are cut; "
                "export the manoeuvre's channels with --format."
            )
        data = plain.read_bytes()
        needed = sorted({int(at) for columns in _messages(plain) for at in _newest(columns, first)})
    records = [data[at - STAMP_BYTES : at + _length(data, at)] for at in needed]
    return b"".join([*records, data[first - STAMP_BYTES : last + _length(data, last)]])


def _messages(log: Path) -> Iterator[Columns]:
    """Yield the messages of a tlog that a stretch may need, with all batches of one sender joined."""
    heard: dict[tuple[str, int, int], list[Columns]] = {}
    for batch in read_tlog(log, BEFORE):
        for columns in batch:
            heard.setdefault((columns.name, columns.system, columns.component), []).append(columns)
    for parts in heard.values():
        fields = {key: np.concatenate([c.fields[key] for c in parts]) for key in BEFORE[parts[0].name]}
        order = np.concatenate([c.order for c in parts])
        arrival = np.concatenate([c.arrival_s for c in parts])
        yield Columns(parts[0].name, parts[0].system, parts[0].component, order, arrival, fields)


def _newest(columns: Columns, first: int) -> IntArray:
    """Return the positions of the newest messages before ``first``, one for each value of the key fields."""
    before = columns.order < first
    order = columns.order[before]
    newest: dict[object, int] = {}
    keys = [columns.fields[key][before].tolist() for key in BEFORE[columns.name]]
    for i, at in enumerate(order.tolist()):
        newest[tuple(key[i] for key in keys)] = at
    return np.array(list(newest.values()), dtype=np.int64)


def _length(data: bytes, at: int) -> int:
    """Return the length of the frame at ``at``, bytes."""
    return len(FrameCutter(CRC_EXTRA).feed(data[at : at + LONGEST_FRAME])[0].raw)


LEAD_S = 10.0
"""Length of flight before the record, s, because best rates are counted over ten seconds."""
AFTER_S = 5.0
"""Length of flight after the record, s, within which a heartbeat and every channel arrive."""


def log_of_maneuver(
    flights: WholeFlights, number: int, aircraft: Aircraft, target_system: int | None = None
) -> bytes:
    """Return the bytes of a tlog in which ``advisor analyze`` finds one manoeuvre.

    The stretch begins ``LEAD_S`` before the record and ends ``AFTER_S`` after it, or at the neighbouring
    manoeuvres.

    Parameters
    ----------
    number
        Number of the manoeuvre, as ``advisor analyze`` counts on these logs.
    target_system
        System id of the vehicle; None for the first one that sends.

    Raises
    ------
    ConfigurationError
        The manoeuvre does not exist, or its log is no tlog.
    UnusableInputError
        The manoeuvre cannot be found in its stretch alone.
    """
    every = [judged.maneuver for judged in flights.state.maneuvers]
    maneuver = next((m for m in every if m.number == number), None)
    if maneuver is None:
        raise ConfigurationError(
            f"--cut: there is no manoeuvre {number}; give a number from 1 to {len(every)}."
        )
    log = flights.logs[maneuver.flight]
    start_s, end_s = _stretch(maneuver, every)
    power_on = next(p for flight, p in flights.power_ons if (flight, p.boot) == maneuver.power_on)
    data = cut_tlog(log, *power_on.arrivals(start_s, end_s))
    if not _finds(data, maneuver, aircraft, target_system):
        raise UnusableInputError(
            "cut",
            f"Manoeuvre {number} cannot be found in its stretch of {log.name} alone.",
            "Analyze the whole log, or mark the manoeuvre with --maneuver.",
        )
    return data


def _stretch(maneuver: Maneuver, every: list[Maneuver]) -> tuple[float, float]:
    """Return the vehicle times between which the packets are taken, s since power-on."""
    span = maneuver.span
    others = [m.span for m in every if m.power_on == maneuver.power_on and m.number != maneuver.number]
    earlier = [s.end_s for s in others if s.end_s <= span.start_s]
    later = [s.start_s for s in others if s.start_s >= span.end_s]
    return max([span.record_from_s - LEAD_S, *earlier]), min([span.end_s + AFTER_S, *later])


def _finds(data: bytes, maneuver: Maneuver, aircraft: Aircraft, target_system: int | None) -> bool:
    """Return whether the cut log contains the manoeuvre, sample by sample."""
    scanner, stream = FrameScanner(), FlightStream(aircraft, target_system)
    events = stream.feed([*scanner.feed(data), *scanner.close()]) + stream.finish()
    return any(isinstance(event, ManeuverFlown) and are_one(event.maneuver, maneuver) for event in events)
