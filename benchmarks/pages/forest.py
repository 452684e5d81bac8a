"""Forest plot of real records: each estimate with its interval, relative to the published value, as SVG."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

from advisor.words.quantities import symbol
from benchmarks.real import Row

_VALUE = re.compile(r"([A-Za-z]\w*) (-?[\d.]+) ± ([\d.]+)")
_ROW, _LEFT, _WIDTH, _TOP, _FOOT = 18, 330, 760, 26, 30
_LOW, _HIGH = 0.4, 1.6
"""Ends of the axis: estimate over published value."""
_GREY, _BLUE = "#9a9a9a", "#0b5394"


@dataclass(frozen=True)
class Compared:
    """One quantity of one record, relative to its published value."""

    label: str
    published_half: float
    """Half of the published interval or tolerance."""
    value: float
    half: float
    """Half of the estimate's 95 % interval."""


def compared(records: Sequence[Row]) -> Iterator[Compared]:
    """Yield every quantity that a record states with a published value other than zero."""
    for record in records:
        published = {name: (float(v), float(h)) for name, v, h in _VALUE.findall(record.asked)}
        for name, value, half in _VALUE.findall(record.got):
            known, known_half = published.get(name, (0.0, 0.0))
            if known:
                aircraft, stem = record.what.partition(",")[0], record.log.partition(".")[0]
                label = f"{stem}, {aircraft}: {symbol(name)}"
                yield Compared(label, abs(known_half / known), float(value) / known, abs(float(half) / known))


def forest(records: Sequence[Row]) -> str:
    """Return the plot; grey: the published interval about 1, blue: the estimate with its 95 % interval."""
    rows = list(compared(records))
    height = _TOP + _ROW * len(rows) + _FOOT
    parts = [
        f'<svg viewBox="0 0 {_WIDTH} {height}" role="img" font-size="11" font-family="sans-serif" '
        'fill="currentColor" aria-label="Estimates of real records over their published values">',
        f'<text x="{_LEFT}" y="14">estimate over published; grey: published, blue: estimated, 95 %</text>',
    ]
    for k, row in enumerate(rows):
        y = _TOP + _ROW * (k + 0.5)
        parts.append(f'<text x="{_LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{escape(row.label)}</text>')
        parts.append(_bar(y, 1.0, row.published_half, _GREY, 7))
        parts.append(_bar(y, row.value, row.half, _BLUE, 2))
        parts.append(_mark(y, row.value))
    bottom = _TOP + _ROW * len(rows)
    for tick in (0.5, 0.75, 1.0, 1.25, 1.5):
        x = _x(tick)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP}" y2="{bottom}" stroke="#cccccc"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle">{tick:g}</text>')
    return "".join([*parts, "</svg>"])


def _x(ratio: float) -> float:
    inside = min(max(ratio, _LOW), _HIGH)
    return _LEFT + (inside - _LOW) / (_HIGH - _LOW) * (_WIDTH - _LEFT - 12)


def _mark(y: float, value: float) -> str:
    """Return a dot, or an arrow at the end of the axis beyond which the value lies."""
    if _LOW <= value <= _HIGH:
        return f'<circle cx="{_x(value):.1f}" cy="{y:.1f}" r="3.5" fill="{_BLUE}"/>'
    tip, step = _x(value), 7.0 if value < _LOW else -7.0
    points = f"{tip:.1f},{y:.1f} {tip + step:.1f},{y - 4:.1f} {tip + step:.1f},{y + 4:.1f}"
    return f'<polygon points="{points}" fill="{_BLUE}"/>'


def _bar(y: float, middle: float, half: float, colour: str, width: int) -> str:
    low, high = _x(middle - half), _x(middle + half)
    return (
        f'<line x1="{low:.1f}" x2="{high:.1f}" y1="{y:.1f}" y2="{y:.1f}" stroke="{colour}" '
        f'stroke-width="{width}"/>'
    )
