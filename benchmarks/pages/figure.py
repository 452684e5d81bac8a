"""The figure of ``docs/gap.md``: a simulator's error in one manoeuvre, before and after, as SVG."""

import math
from collections.abc import Iterator

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.result import Diagnosis, Trace

_WIDTH, _LEFT, _RIGHT, _TOP, _PANEL, _GAP = 720, 96, 8, 30, 84, 14
_UNITS = {
    "alpha": ("α", "deg", math.degrees(1.0)),
    "q": ("q", "deg/s", math.degrees(1.0)),
    "a_z": ("a_z", "m/s²", 1.0),
    "theta": ("θ", "deg", math.degrees(1.0)),
}
_BEFORE, _AFTER, _GREY = "#b5482f", "#1f6f8b", "#7a7a7a"
"""Colours that a reader without red or green keeps apart by their lightness, on white and on black."""


def figure(d: Diagnosis) -> str:
    """Each channel's error in the manoeuvre with the largest gap."""
    number = max(d.gap.by_maneuver, key=lambda row: row[1])[0]
    traces = [trace for trace in d.traces if trace.number == number]
    height = _TOP + len(traces) * (_PANEL + _GAP) + 30
    begins = min(float(trace.t[0]) for trace in traces)
    lasts = max(float(trace.t[-1]) for trace in traces) - begins
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" '
        'font-family="sans-serif" font-size="12">',
        f"<title>Error of the simulator in manoeuvre {number}, before and after</title>",
        _text(_LEFT, 18, f"manoeuvre {number}: measured less simulated", _GREY),
        _text(_LEFT + 300, 18, "before", _BEFORE),
        _text(_LEFT + 360, 18, "after", _AFTER),
        *(part for n, trace in enumerate(traces) for part in _panel(n, trace, begins, lasts)),
        *_seconds(lasts, height),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _panel(n: int, trace: Trace, begins: float, lasts: float) -> Iterator[str]:
    name, unit, factor = _UNITS[trace.channel]
    before, after = (factor * (trace.measured - flown) for flown in (trace.before, trace.after))
    peak = float(max(np.max(np.abs(before)), np.max(np.abs(after))))
    top = _TOP + n * (_PANEL + _GAP)
    middle = top + _PANEL / 2
    yield _line(_LEFT, middle, _WIDTH - _RIGHT, middle)
    yield _text(8, middle + 4, f"{name}, {unit}", _GREY)
    for label, y in ((f"{peak:+.2g}", top + 10), (f"{-peak:+.2g}".replace("-", "−"), top + _PANEL)):
        yield _text(_LEFT - 38, y, label, _GREY)
    for error, colour in ((before, _BEFORE), (after, _AFTER)):
        x = _LEFT + (trace.t - begins) / lasts * (_WIDTH - _LEFT - _RIGHT)
        yield _curve(x, middle - error / peak * _PANEL / 2, colour)


def _seconds(lasts: float, height: int) -> Iterator[str]:
    for second in range(0, int(lasts) + 1, 2):
        x = _LEFT + second / lasts * (_WIDTH - _LEFT - _RIGHT)
        yield _text(x, height - 12, f"{second} s", _GREY)


def _curve(x: FloatArray, y: FloatArray, colour: str) -> str:
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.3"/>'


def _line(*ends: float) -> str:
    x1, y1, x2, y2 = ends
    return f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{_GREY}" stroke-width="0.5"/>'


def _text(x: float, y: float, text: str, colour: str) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" fill="{colour}">{text}</text>'
