"""The results of a batch as tables: flights, manoeuvres, and the tests for a change."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf
from typing import Any

import numpy as np

from advisor import __version__
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis.marks_file import SINCE_1970_S
from advisor.batch.flight import Analyzed
from advisor.decision.change import Change, find_change
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES, posteriors_at_one_speed
from advisor.exports.flights.findings import PARAMETER_UNITS, SIDE_UNITS
from advisor.exports.flights.table import Column, Dataset, FlightTable, counts, numbers, texts, truths
from advisor.oem.estimate import Estimate
from advisor.words.quantities import NORMAL_95, symbol, with_half


@dataclass(frozen=True, slots=True)
class ChangeOverFlights:
    """A change between two flights of one aircraft."""

    since: int
    """Number of the first flight after the change."""
    change: Change
    """Change between the compared flights, whose numbers count from the first flight."""
    sentence: str


def change_over_flights(flights: Sequence[tuple[int, Estimate]]) -> ChangeOverFlights | None:
    """Return the most significant change over the flights of one aircraft; None if noise explains all
    differences.

    Parameters
    ----------
    flights
        Number and joint estimate of each flight, in the order of flying.
    """
    change = find_change([CandidateManeuver(estimate) for _, estimate in flights])
    if change is None:
        return None
    since = flights[change.after][0]
    moved = ", ".join(
        f"{symbol(m.parameter)} is {abs(m.percent):.0f} % {'larger' if m.percent > 0.0 else 'smaller'}"
        for m in change.moved
    )
    cause = f"; it looks like {change.looks_like}" if change.looks_like else ""
    doubt = "" if change.confirmed else "; only one flight shows the change"
    return ChangeOverFlights(since, change, f"Since flight {since} {moved}{cause}{doubt}.")


def lying_apart(flights: Sequence[tuple[int, Estimate]]) -> str:
    """Return a sentence on the two flights whose 95 % intervals of one derivative lie farthest apart; empty
    where all intervals of every derivative overlap.

    Parameters
    ----------
    flights
        Number and joint estimate of each flight, in the order of flying.
    """
    posteriors = posteriors_at_one_speed([estimate for _, estimate in flights])
    farthest, sentence = 1.0, ""
    for (i, first), (j, second) in combinations(enumerate(posteriors), 2):
        for k in DERIVATIVES:
            widths = NORMAL_95 * (first.std[k] + second.std[k])
            distance = abs(float(first.theta[k] - second.theta[k]))
            if distance > farthest * widths:
                farthest = distance / widths
                values = " and ".join(
                    with_half(float(p.theta[k]), NORMAL_95 * float(p.std[k])) for p in (first, second)
                )
                numbers = f"{flights[i][0]} and {flights[j][0]}"
                sentence = f"{symbol(PARAMETERS[k])} of flights {numbers} lies apart: {values}."
    return sentence


def in_order(results: Sequence[Analyzed]) -> list[Analyzed]:
    """Return flights, the oldest first if all usable flights have dates, else in the given order."""
    if not all(SINCE_1970_S <= result.began_s < inf for result in results if result.usable):
        return list(results)
    return sorted(results, key=lambda result: result.began_s if result.usable else inf)


def estimates_of(flights: Sequence[Analyzed]) -> dict[str, list[tuple[int, Estimate]]]:
    """Return the number and joint estimate of each flight that has one, by the name of its aircraft."""
    by_aircraft: dict[str, list[tuple[int, Estimate]]] = {}
    for number, flight in enumerate(flights, start=1):
        if (estimate := flight.estimate) is not None:
            by_aircraft.setdefault(aircraft_of(flight), []).append((number, estimate))
    return by_aircraft


def changes_of(flights: Sequence[Analyzed]) -> dict[str, ChangeOverFlights]:
    """Return the change over the flights of each aircraft, by the name of the aircraft.

    Flights without an aircraft file may belong to several aircraft, so no change is sought among them.
    """
    named = estimates_of([flight for flight in flights if flight.is_named])
    changes = {name: change_over_flights(several) for name, several in named.items()}
    return {name: change for name, change in changes.items() if change is not None}


def not_told_apart(flights: Sequence[Analyzed]) -> dict[str, str]:
    """Return a sentence for each identity without an aircraft file whose flights contradict each other.

    A system id is 1 by default, so that it identifies no aircraft. Flights without an aircraft file that
    agree count as flights of one aircraft.
    """
    sentences = {}
    nameless = [replace(f, joint={}) if f.is_named else f for f in flights]
    for name, several in estimates_of(nameless).items():
        apart = lying_apart(several)
        if apart:
            speeds = [e.airspeed_m_s for _, e in several if e.airspeed_m_s is not None]
            flown = f" They were flown at {min(speeds):.0f} to {max(speeds):.0f} m/s." if speeds else ""
            sentences[name] = (
                f"Not distinguished: {name} may be one aircraft that has changed, or several. {apart}{flown} "
                "Give --aircraft for one aircraft, or --aircraft-map for several."
            )
    return sentences


def aircraft_of(flight: Analyzed) -> str:
    """Return the identity of an aircraft: its aircraft file and the kind of autopilot."""
    vehicle = flight.document["log"]["vehicle"] or {}
    system = f"system {vehicle['system']}" if vehicle else ""
    return " ".join(filter(None, (flight.aircraft_file, vehicle.get("autopilot"), system)))


def names_of(flights: Sequence[Analyzed]) -> dict[str, str]:
    """Return the name of each aircraft for people, by the aircraft's identity.

    Aircraft that share a name have their identity in brackets behind the name. Nameless aircraft show their
    identity alone.
    """
    names = {aircraft_of(flight): flight.aircraft_name for flight in flights}
    often = Counter(names.values())
    shared = {identity: f"{name} ({identity})" for identity, name in names.items() if often[name] > 1}
    return {identity: (name and shared.get(identity, name)) or identity for identity, name in names.items()}


def mixed_up(flights: Sequence[Analyzed]) -> list[str]:
    """Return a sentence for each aircraft file that logs of several aircraft share."""
    by_file: dict[str, dict[str, str]] = {}
    for flight in flights:
        if flight.usable:
            by_file.setdefault(flight.aircraft_file, {}).setdefault(aircraft_of(flight), flight.log)
    return [
        f"Logs of different aircraft, each compared with its own flights only: "
        f"{'; '.join(f'{aircraft} in {log}' for aircraft, log in several.items())}. "
        "Give each aircraft a file of its own with --aircraft-map."
        for several in by_file.values()
        if len(several) > 1
    ]


def tables_of(flights: Sequence[Analyzed]) -> Dataset:
    """Return tables with a row for each flight, manoeuvre, and parameter of a change.

    Parameters
    ----------
    flights
        In the order of flying; flights are numbered from 1.
    """
    about = {"advisor": __version__, "logs": [{"file": f.log, "sha256": f.sha256} for f in flights]}
    return Dataset((), (_flights(flights), _maneuvers(flights), _changes(changes_of(flights))), about)


def is_whole(result: Analyzed) -> bool:
    """Return whether a stored result contains all data of the tables. Another version of the advisor may have
    stored a different result."""
    try:
        tables_of([result])
        estimates_of([result])
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):
        return False
    return True


def _flights(flights: Sequence[Analyzed]) -> FlightTable:
    documents = [flight.document for flight in flights]
    tests = [document["flight_test"] or {} for document in documents]
    sides = [f.lateral.get("flight_test") or {} for f in flights]
    verdicts = [[m["verdict"] for m in document["maneuvers"]] for document in documents]
    lateral = [[m["verdict"] for m in f.lateral.get("maneuvers", ())] for f in flights]
    columns = [
        Column("flight", np.arange(1, len(flights) + 1), "", "number in the order of flying"),
        Column("log", texts([f.log for f in flights]), "", "file of the log"),
        Column("sha256", texts([f.sha256 for f in flights]), "", "SHA-256 of the log"),
        Column("aircraft", texts([aircraft_of(f) for f in flights]), "", "aircraft file, autopilot, id"),
        Column("began_s", numbers([f.began_s for f in flights]), "s", "begin of the log since 1970"),
        Column("duration_s", numbers([d["log"]["duration_s"] for d in documents]), "s", "vehicle time heard"),
        Column("usable", truths([f.usable for f in flights]), "", "whether the log counts"),
        Column(
            "problems",
            texts([" ".join(f.reasons) for f in flights]),
            "",
            "reason why the flight does not count",
        ),
        Column("maneuvers", counts([len(v) for v in verdicts]), "1", "number of manoeuvres"),
        Column("accepted", counts([v.count("accepted") for v in verdicts]), "1", "how many count"),
        Column("decision", texts(list(map(decided, tests))), "", "complete or not complete"),
        Column(
            "criterion_percent", numbers([t.get("criterion_percent") for t in tests]), "%", "stop criterion"
        ),
        Column(
            "airspeed_m_s",
            numbers([f.joint.get("airspeed_m_s") for f in flights]),
            "m/s",
            "air speed at which the derivatives are given",
        ),
        *_parameters([d["model"] for d in documents], "of the joint estimate"),
        Column(
            "lateral_maneuvers", counts([len(v) for v in lateral]), "1", "number of roll and yaw manoeuvres"
        ),
        Column(
            "lateral_accepted",
            counts([v.count("accepted") for v in lateral]),
            "1",
            "number of accepted roll and yaw manoeuvres",
        ),
        Column("lateral_decision", texts(list(map(decided, sides))), "", "complete or not complete"),
        *_parameters([f.lateral.get("model") for f in flights], "of the joint estimate", SIDE_UNITS),
    ]
    return FlightTable("flights", "A row is a flight: one log.", tuple(columns))


def decided(test: Mapping[str, Any]) -> str:
    """Return the decision's word for the flight test of a flight that is over; empty without a decision."""
    return {"stop": "complete", "continue": "not complete"}.get(test.get("decision", ""), "")


def _maneuvers(flights: Sequence[Analyzed]) -> FlightTable:
    rows = [(k, m) for k, f in enumerate(flights, start=1) for m in f.maneuvers]
    flown = [m for _, m in rows]
    pitch = [None if _is_lateral(m) else m["estimates"] for m in flown]
    lateral = [m["estimates"] if _is_lateral(m) else None for m in flown]
    columns = [
        Column("flight", counts([k for k, _ in rows]), "", "number of the flight"),
        Column("maneuver", counts([m["number"] for m in flown]), "", "number in the flight"),
        Column(
            "boot",
            counts([m["boot"] for m in flown]),
            "",
            "number of the power-on in the log, counted from 0",
        ),
        Column("start_boot_s", numbers([m["start_boot_s"] for m in flown]), "s", "onset of the first step"),
        Column("end_boot_s", numbers([m["end_boot_s"] for m in flown]), "s", "end of the free response"),
        Column("input", texts([m["input"] for m in flown]), "", "kind of input"),
        Column("mode", texts([m["mode"] for m in flown]), "", "flight mode"),
        Column("accepted", truths([m["verdict"] == "accepted" for m in flown]), "", "verdict"),
        Column("sentence", texts([m["sentence"] for m in flown]), "", "verdict as the pilot reads it"),
        Column("reason_codes", texts([_codes(m) for m in flown]), "", "stable codes of the reasons"),
        Column("cost", numbers([m["cost"] for m in flown]), "", "J of Eq. (7)"),
        Column("axis", texts(["lateral" if _is_lateral(m) else "pitch" for m in flown]), "", "axis tested"),
        *_parameters(pitch, "of the manoeuvre"),
        *_parameters(lateral, "of the manoeuvre", SIDE_UNITS),
    ]
    return FlightTable("maneuvers", "A row is a manoeuvre.", tuple(columns))


def _changes(changes: dict[str, ChangeOverFlights]) -> FlightTable:
    rows = [(name, c, moved) for name, c in changes.items() for moved in c.change.moved]
    columns = (
        Column("aircraft", texts([name for name, _, _ in rows]), "", "aircraft file, autopilot, id"),
        Column("since_flight", counts([c.since for _, c, _ in rows]), "", "first flight after the change"),
        Column("parameter", texts([moved.parameter for *_, moved in rows]), "", "derivative that moved"),
        Column("percent", numbers([moved.percent for *_, moved in rows]), "%", "growth of its size"),
        Column("sigma", numbers([moved.sigma for *_, moved in rows]), "1", "difference over its std"),
        Column("confirmed", truths([c.change.confirmed for _, c, _ in rows]), "", "two flights agree"),
        Column("sentence", texts([c.sentence for _, c, _ in rows]), "", "change in words"),
    )
    return FlightTable("changes", "A row is a derivative that moved from one flight to the next.", columns)


def _parameters(
    estimates: Sequence[dict[str, Any] | None], of: str, units: Mapping[str, str] = PARAMETER_UNITS
) -> list[Column]:
    """Return the value and standard deviation of each parameter with a unit; NaN where there is none."""
    columns = []
    for name, unit in units.items():
        for key, suffix in (("value", ""), ("std", "_std")):
            values = numbers([e[name][key] if e and name in e else None for e in estimates])
            columns.append(Column(f"{name}{suffix}", values, unit, f"{key} {of}"))
    return columns


def _is_lateral(maneuver: Mapping[str, Any]) -> bool:
    return "modes" in maneuver


def _codes(maneuver: dict[str, Any]) -> str:
    return " ".join(reason["code"] for reason in maneuver["reasons"])
