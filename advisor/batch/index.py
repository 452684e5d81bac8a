"""The page of a batch: one row for each flight, and each derivative over the flights."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from html import escape
from importlib.resources import files
from math import floor, inf, isfinite, log10
from os.path import commonpath
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple
from urllib.parse import quote

from advisor import __version__
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis.marks_file import SINCE_1970_S
from advisor.batch.flight import Analyzed
from advisor.batch.tables import (
    ChangeOverFlights,
    aircraft_of,
    changes_of,
    estimates_of,
    lying_apart,
    names_of,
    not_told_apart,
)
from advisor.decision.pooling import DERIVATIVES, common_airspeed, posteriors_at_one_speed
from advisor.oem.estimate import Estimate
from advisor.words.problems import printable
from advisor.words.quantities import NORMAL_95, signed, symbol, with_half
from advisor.words.quantities import PARAMETERS as QUANTITIES

WIDTH, HEIGHT = 320, 182
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 312, 24, 144
_INK, _PALE, _MARK = "#0b5394", "#ddd", "#b45f06"


class Point(NamedTuple):
    """One flight in the picture of a derivative."""

    flight: int
    value: float
    half: float
    """Half of the 95 % interval. The value is not finite if the flight did not determine the derivative."""


def trend_svg(name: str, unit: str, points: Sequence[Point], since: int | None) -> str:
    """Draw values with 95 % intervals against the number of the flight.

    Parameters
    ----------
    points
        Flights in the order of flying. A flight without a finite interval is left out.
    since
        First flight after a change of this derivative, marked by a dashed line. None without a change.
    """
    shown = [point for point in points if isfinite(point.value) and isfinite(point.half)]
    title = f"{name}, {unit}" if unit != "1" else name
    if not shown:
        return _framed(
            title, [_text(WIDTH / 2, HEIGHT / 2, "no flight determines this derivative", "middle")]
        )
    first, last = points[0].flight - 0.5, points[-1].flight + 0.5
    ticks, decimals = _ticks(min(p.value - p.half for p in shown), max(p.value + p.half for p in shown))

    def x(flight: float) -> float:
        return _LEFT + (flight - first) / (last - first) * (_RIGHT - _LEFT)

    def y(value: float) -> float:
        return _BOTTOM - (value - ticks[0]) / (ticks[-1] - ticks[0]) * (_BOTTOM - _TOP)

    parts = []
    for tick in ticks:
        parts.append(_line(_LEFT, y(tick), _RIGHT, y(tick), _PALE))
        parts.append(_text(_LEFT - 5, y(tick) + 4, signed(tick, decimals), "end"))
    ends = sorted({points[0].flight, points[-1].flight})
    parts += [_text(x(flight), _BOTTOM + 16, str(flight), "middle") for flight in ends]
    parts.append(_text((_LEFT + _RIGHT) / 2, HEIGHT - 6, "flight", "middle"))
    if since is not None:
        at = x(since - 0.5)
        parts.append(_line(at, _TOP, at, _BOTTOM, _MARK, ' stroke-width="2" stroke-dasharray="5 3"'))
    for point in shown:
        at, half = x(point.flight), point.half
        bar = _line(at, y(point.value - half), at, y(point.value + half), _INK, ' stroke-width="1.5"')
        dot = f'<circle cx="{at:.1f}" cy="{y(point.value):.1f}" r="2.5" fill="{_INK}"/>'
        tooltip = f"<title>flight {point.flight}: {with_half(point.value, half)} {escape(unit)}</title>"
        parts.append(f'<g class="flight">{tooltip}{bar}{dot}</g>')
    return _framed(title, parts)


def _ticks(low: float, high: float) -> tuple[list[float], int]:
    """Return two to six round numbers that enclose an interval, and their decimals."""
    span = max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-12)
    power = floor(log10(span))
    size = span / 10.0**power
    step = 10.0**power * (0.5 if size < 2.0 else 1.0 if size < 4.0 else 2.0)
    first, last = floor(low / step), -floor(-high / step)
    decimals = max(0, -floor(log10(step)))
    return [k * step for k in range(first, max(last, first + 1) + 1)], decimals


def _framed(title: str, parts: Sequence[str]) -> str:
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(title)} over flights"'
        ' font-family="sans-serif" font-size="11" fill="#222">'
        f"{_text(_LEFT, 14, title, 'start')}{''.join(parts)}</svg>"
    )


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'


def _line(x1: float, y1: float, x2: float, y2: float, color: str, more: str = "") -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}"{more}/>'


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
