"""The page of a batch: one row for each flight, and each derivative over the flights."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from html import escape
from importlib.resources import files
from math import inf
from os.path import commonpath
from pathlib import Path
from types import MappingProxyType
from urllib.parse import quote

from advisor import __version__
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis.log_series import SINCE_1970_S
from advisor.batch.flight import Analyzed
from advisor.batch.picture import Point, trend_svg
from advisor.batch.tables import aircraft_of, changes_of, estimates_of, names_of, not_told_apart
from advisor.batch.trend import ChangeOverFlights, lying_apart
from advisor.decision.pooling import DERIVATIVES, common_airspeed, posteriors_at_one_speed
from advisor.oem.estimate import Estimate
from advisor.words.printable import printable
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import PARAMETERS as QUANTITIES
from advisor.words.quantities import symbol

_COLUMNS = ("Flight", "Log", "Begun, UTC", "Aircraft", "Accepted", "Result")

_STYLE = "td:nth-child(3) { white-space: nowrap; }\n"
"""Page style for a date on one line."""


def index_page(flights: Sequence[Analyzed], reports: Mapping[Path, str] = MappingProxyType({})) -> str:
    """Write the page: self-contained HTML without script, reproducible from equal flights.

    Parameters
    ----------
    flights
        Results in the order of flying, numbered from 1.
    reports
        Log to the place of its page, relative to this page.
    """
    failures = sum(not flight.usable for flight in flights)
    changes, names, apart = changes_of(flights), names_of(flights), not_told_apart(flights)
    style = files("advisor.report.page").joinpath("page.css").read_text(encoding="utf-8")
    trends = [
        _trends(names[identity], several, changes.get(identity), apart.get(identity, ""))
        for identity, several in estimates_of(flights).items()
    ]
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>Flights of a batch</title>\n<style>\n{style}{_STYLE}</style></head>\n<body>",
            "<h1>Flights of a batch</h1>",
            f"<p>Logs: {len(flights)}. Logs that cannot be used: {failures}.</p>",
            "<h2>Flights</h2>",
            _table(flights, names, reports),
            *trends,
            f'<p class="note">Written by the inflight advisor {escape(__version__)}.</p>\n</body></html>\n',
        ]
    )


def _trends(
    name: str, flights: Sequence[tuple[int, Estimate]], change: ChangeOverFlights | None, apart: str
) -> str:
    """Return the sentence of the change test for one aircraft, and a picture for each derivative."""
    estimates = [estimate for _, estimate in flights]
    posteriors = posteriors_at_one_speed(estimates)
    speed = common_airspeed(estimates)
    moved = {part.parameter for part in change.change.moved} if change else set()
    pictures = []
    for k in DERIVATIVES:
        points = [
            Point(number, float(posterior.theta[k]), NORMAL_95 * float(posterior.std[k]))
            for (number, _), posterior in zip(flights, posteriors, strict=True)
        ]
        since = change.since if change and PARAMETERS[k] in moved else None
        picture = trend_svg(symbol(PARAMETERS[k]), QUANTITIES[PARAMETERS[k]].unit, points, since)
        pictures.append(f'<figure class="third">{picture}</figure>')
    at = f" brought to an air speed of {speed:.1f} m/s" if speed is not None else ""
    return (
        f"<h2>{_shown(name) or 'Aircraft'}</h2>\n"
        f'<p class="verdict">{_shown(apart or _sentence(flights, change))}</p>\n'
        f'<p class="note">Joint estimate of each flight{at} with its 95 % interval; a dashed line marks'
        f' a change.</p>\n<div class="gallery">{"".join(pictures)}</div>'
    )


def _sentence(flights: Sequence[tuple[int, Estimate]], change: ChangeOverFlights | None) -> str:
    if change is not None:
        return change.sentence
    apart = lying_apart(flights)
    if apart:
        return f"{apart} The change test over {len(flights)} flights does not show when the change began."
    if len(flights) < 3:
        return f"Flights with a joint estimate: {len(flights)}; a change needs at least three flights."
    return (
        f"The change test over {len(flights)} flights finds no change, and all intervals overlap;"
        " the test cannot judge the first flight alone."
    )


def _table(flights: Sequence[Analyzed], names: Mapping[str, str], reports: Mapping[Path, str]) -> str:
    head = "".join(f"<th>{name}</th>" for name in _COLUMNS)
    logs = _below_their_folder([flight.log for flight in flights])
    rows = "\n".join(
        _row(number, flight, log, names[aircraft_of(flight)], reports.get(Path(flight.log)))
        for number, (flight, log) in enumerate(zip(flights, logs, strict=True), start=1)
    )
    return f'<table id="flights"><thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody></table>'


def _below_their_folder(logs: Sequence[str]) -> list[str]:
    """Return the paths of logs below their common folder; full paths if some are not absolute."""
    try:
        folder = commonpath([Path(log).parent for log in logs])
    except ValueError:
        return list(logs)
    return [str(Path(log).relative_to(folder)) for log in logs]


def _row(number: int, flight: Analyzed, log: str, aircraft: str, report: str | None) -> str:
    dated = SINCE_1970_S <= flight.began_s < inf
    cells = (
        str(number),
        log,
        f"{datetime.fromtimestamp(flight.began_s, UTC):%Y-%m-%d %H:%M}" if dated else "not dated",
        aircraft,
        _accepted(flight),
        _results(flight) if flight.usable else f"Cannot be used: {' '.join(flight.reasons)}",
    )
    shown = [_shown(cell) for cell in cells]
    if report is not None:
        shown[1] = f'<a href="{quote(report)}">{shown[1]}</a>'
    row = "".join(f'<td data-label="{name}">{cell}</td>' for name, cell in zip(_COLUMNS, shown, strict=True))
    return f"<tr>{row}</tr>"


def _accepted(flight: Analyzed) -> str:
    """Return the numbers of accepted manoeuvres of the elevator and of aileron and rudder."""
    pitch, lateral = (
        [m["verdict"] for m in several]
        for several in (flight.document["maneuvers"], flight.lateral.get("maneuvers", ()))
    )
    counted = f"{pitch.count('accepted')} of {len(pitch)}"
    if not lateral:
        return counted
    return f"{counted}; roll and yaw {lateral.count('accepted')} of {len(lateral)}"


def _results(flight: Analyzed) -> str:
    """Return the sentences on the flight tests of the axes that were flown."""
    said = [_result(flight.document["flight_test"]["sentence"])]
    if flight.lateral.get("maneuvers"):
        said.append(f"Roll and yaw: {_result(flight.lateral['flight_test']['sentence'])}")
    return " ".join(said)


def _result(sentence: str) -> str:
    """Return the result of a finished flight's test as a sentence, without a request for more manoeuvres."""
    begin, _, rest = sentence.partition(": ")
    return f"Not complete: {rest}" if begin == "CONTINUE" else sentence


def _shown(text: str) -> str:
    return escape(printable(text))
