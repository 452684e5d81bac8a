"""The advisor in a notebook: read a log, find manoeuvres, estimate, judge, diagnose.

The functions give the numbers of the commands ``advisor analyze`` and ``advisor gap``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import as_in_tables, compare_logs
from advisor.analysis.marks_file import read_by_hand
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown
from advisor.flight.signals.track import PowerOn
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.gap.result import Diagnosis
from advisor.mavlink.logs.logs import read_whole_log
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate as estimate_one
from advisor.oem.estimator import estimate_jointly
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError


@dataclass(frozen=True, slots=True)
class Flight:
    """One vehicle's flight, read from one log by :func:`read`."""

    log: Path
    aircraft: Aircraft
    """Aircraft as described by its crew."""
    vehicle: Vehicle | None
    """Vehicle of the log. None where no heartbeat was heard."""
    power_ons: tuple[PowerOn, ...] = field(repr=False)
    """Records of every power-on of the vehicle. ``power_ons[0].channels["q"]`` has stamps ``t`` (s since
    boot) and values ``y`` (SI), shape (n,) each.
    """
    maneuvers: tuple[Maneuver, ...] = field(repr=False)
    """Manoeuvres in the order of flying, numbered from 1."""
    problems: tuple[Problem, ...]
    """Reasons for which the log cannot be used, with their remedies; empty for a usable log."""
    notes: tuple[str, ...]
    """Assumptions about the elevator, as sentences."""


def read(log: str | PathLike[str], aircraft: Aircraft | str | PathLike[str] | None = None) -> Flight:
    """Read a log: every channel at its own stamps, and the manoeuvres.

    Parameters
    ----------
    log : str or path
        Path of a ``.tlog``, an ArduPilot ``.bin``, a PX4 ``.ulg`` or a table, compressed or not. The marks in
        ``LOG.maneuvers.yaml`` next to the log are applied.
    aircraft : Aircraft, str or path, optional
        The aircraft, or its YAML file; by default nothing is known of it.

    Returns
    -------
    Flight
        The flight, even if the log cannot be used for estimates; ``problems`` then gives the reasons.

    Raises
    ------
    UnusableInputError
        The file is missing or holds no log.
    ConfigurationError
        The aircraft file, or the file of marks, is wrong.
    """
    path = Path(log)
    described = as_in_tables(aircraft if isinstance(aircraft, Aircraft) else _described(aircraft), [path])
    stream = FlightStream(described, marks=read_by_hand(path).marks, keep_all=True)
    events = [
        event for columns in read_whole_log(path, columns=described.columns) for event in stream.feed(columns)
    ] + stream.finish()
    return Flight(
        path,
        described,
        stream.vehicle,
        tuple(stream.power_ons),
        tuple(event.maneuver for event in events if isinstance(event, ManeuverFlown)),
        tuple(stream.problems()),
        stream.elevator_notes,
    )


def find(flight: Flight) -> tuple[Maneuver, ...]:
    """Return the manoeuvres of a flight, in the order of flying.

    Returns
    -------
    tuple of Maneuver
        Manoeuvres with a ``span`` (times in s since boot) and ``channels``. A channel's name gives stamps
        ``t`` and values ``y``, shape (n,) each, SI.

    Raises
    ------
    UnusableInputError
        The log cannot be used: no elevator, a rate too low, no manoeuvre, ...
    """
    if flight.problems:
        raise UnusableInputError.of(flight.problems)
    return flight.maneuvers


def estimate(
    maneuvers: Maneuver | Sequence[Maneuver], aircraft: Aircraft | None = None
) -> Estimate | NoEstimate:
    """Return the eight parameters of the short period, from one manoeuvre or from several together.

    Parameters
    ----------
    maneuvers : Maneuver or sequence of Maneuver
        Several manoeuvres share their derivatives; each manoeuvre keeps its own trim, initial state and
        biases.
    aircraft : Aircraft, optional
        The aircraft; by default nothing is known of it.

    Returns
    -------
    Estimate or NoEstimate
        ``theta`` and ``std``, shape (8,), and ``covariance``, shape (8, 8), in the order Z_0, Z_alpha, Z_q,
        Z_delta_e, M_0, M_alpha, M_q, M_delta_e, rad and s. A failed fit returns ``NoEstimate`` with its
        reason in ``text``.
    """
    described = aircraft or Aircraft()
    if isinstance(maneuvers, Maneuver):
        return estimate_one(maneuvers, described)
    return estimate_jointly(maneuvers, described)


def judge(flights: Flight | Sequence[Flight]) -> CampaignState:
    """Return verdicts on all manoeuvres, the joint estimate and the stop criterion, as in ``advisor
    analyze``.

    Parameters
    ----------
    flights : Flight or sequence of Flight
        One flight, or the flights of one campaign. The logs are read again, oldest first if all logs have a
        date. Decisions by hand are applied.

    Returns
    -------
    CampaignState
        ``maneuvers`` with ``estimate`` and ``verdict`` each, ``model`` (joint estimate), ``flight_test``
        (stop or continue, criterion in percent).

    Raises
    ------
    UnusableInputError
        No log can be used.
    ConfigurationError
        The flights were read with different aircraft, or there is none.
    """
    several = _several(flights)
    return read_whole([flight.log for flight in several], _one_aircraft(several)).state


def diagnose(flights: Flight | Sequence[Flight], holdout: int | None = None) -> Diagnosis:
    """Return the diagnosis of ``advisor gap``: why the aircraft does not fly like its simulator.

    Parameters
    ----------
    flights : Flight or sequence of Flight
        One flight, or the flights of one campaign. The logs of the given flights are read again.
    holdout : int, optional
        Measure on so many manoeuvres, the last ones, with numbers fitted without them; by default the
        diagnosis chooses.

    Returns
    -------
    Diagnosis
        ``verdict``, ``sentence``, ``causes`` (ranked, with probabilities), ``gap``, ``shrink``.

    Raises
    ------
    UnusableInputError
        A log cannot be used, or the manoeuvres are too few.
    ConfigurationError
        The flights were read with different aircraft, or there is none.
    """
    several = _several(flights)
    logs = [flight.log for flight in several]
    by_hand = [read_by_hand(log) for log in logs]
    return compare_logs(logs, _one_aircraft(several), holdout, by_hand=by_hand).diagnosis


def _described(file: str | PathLike[str] | None) -> Aircraft:
    return load_aircraft(None if file is None else Path(file))


def _several(flights: Flight | Sequence[Flight]) -> Sequence[Flight]:
    return [flights] if isinstance(flights, Flight) else flights


def _one_aircraft(flights: Sequence[Flight]) -> Aircraft:
    if not flights:
        raise ConfigurationError("There is no flight: give at least one that advisor.read has made.")
    first = flights[0].aircraft
    other = next((flight for flight in flights if flight.aircraft != first), None)
    if other is not None:
        raise ConfigurationError(
            f"{other.log} was read with another aircraft than {flights[0].log}: read all flights of a "
            "campaign with one."
        )
    return first
