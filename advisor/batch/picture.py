"""Picture of one derivative over flights: SVG without script, written by hand."""

from collections.abc import Sequence
from html import escape
from math import floor, isfinite, log10
from typing import NamedTuple

from advisor.words.digits import signed, with_half

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
