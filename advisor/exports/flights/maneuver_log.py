"""Stretch of a log that belongs to one manoeuvre, and a check that the cut log still contains it."""

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.whole_flights import WholeFlights
from advisor.exports.flights.cut import cut_tlog
from advisor.flight.maneuvers.events import ManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver, are_one
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import ConfigurationError, UnusableInputError

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
            f"Manoeuvre {number} cannot be told by its stretch of {log.name} alone.",
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
