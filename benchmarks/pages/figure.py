"""Figures of the explanations, from the manoeuvres of a shipped log, as SVG."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis, Trace
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray

_WIDTH, _LEFT, _RIGHT, _TOP, _PANEL, _GAP = 720, 96, 8, 30, 84, 14
_UNITS: Mapping[str, tuple[str, str, float]] = {
    "elevator": ("δe", "deg", math.degrees(1.0)),
    "alpha": ("α", "deg", math.degrees(1.0)),
    "q": ("q", "deg/s", math.degrees(1.0)),
    "a_z": ("a_z", "m/s²", 1.0),
    "theta": ("θ", "deg", math.degrees(1.0)),
}
"""Channel to its letter, the unit of people and the factor from the SI unit."""
_FIRST, _SECOND, _GREY = "#c4553a", "#2b86a8", "#7a7a7a"
"""Colours that a reader without red or green keeps apart by their lightness, on white and on black."""


@dataclass(frozen=True)
class Panel:
    """One channel of a figure."""

    channel: str
    curves: Sequence[tuple[FloatArray, FloatArray]]
    """Stamps in s and values in SI units; the first curve has the first colour, the second the other."""
    half_band: float = 0.0
    """Half the height of a grey band about zero, SI."""


@dataclass(frozen=True)
class Drawing:
    """A figure: panels over one time axis."""

    title: str
    legend: Sequence[str]
    """Names of the curves."""
    panels: Sequence[Panel]
    marks: Mapping[str, float]
    """Name of a moment to its stamp, s."""


def errors(d: Diagnosis) -> Drawing:
    """Each channel's error in the manoeuvre with the largest gap, before and after."""
    number = max(d.gap.by_maneuver, key=lambda row: row[1])[0]
    traces = [trace for trace in d.traces if trace.number == number]
    panels = [Panel(trace.channel, _errors_of(trace)) for trace in traces]
    return Drawing(f"manoeuvre {number}: measured less simulated", ("before", "after"), panels, {})


def response(maneuver: Maneuver, estimate: Estimate) -> Drawing:
    """The input, and the measured and the fitted response."""
    elevator = maneuver.channels["elevator"]
    fits = estimate.fits[0]
    panels = [Panel("elevator", [(elevator.t, elevator.y)])]
    panels += [
        Panel(name, [(fits[name].t, fits[name].measured), (fits[name].t, fits[name].fitted)])
        for name in ("alpha", "q")
    ]
    return Drawing(f"manoeuvre {maneuver.number}, {maneuver.span.kind}", ("measured", "model"), panels, {})


def residuals(maneuver: Maneuver, estimate: Estimate) -> Drawing:
    """The residual of each output, and the band that holds 95 % of white noise."""
    panels = [
        Panel(name, [(fit.t, fit.residual)], 1.96 * fit.noise) for name, fit in estimate.fits[0].items()
    ]
    return Drawing(f"manoeuvre {maneuver.number}: residuals, and ±1.96 σ", (), panels, {})


def stages(maneuver: Maneuver) -> Drawing:
    """The record of a manoeuvre: before the input, the input, the free response."""
    span = maneuver.span
    panels = [
        Panel(name, [(maneuver.channels[name].t, maneuver.channels[name].y)]) for name in ("elevator", "q")
    ]
    marks = {"first step": span.start_s, "last step": span.last_step_s, "end": span.end_s}
    return Drawing(f"the record of manoeuvre {maneuver.number}", (), panels, marks)


def svg(drawing: Drawing) -> str:
    """The drawing as SVG."""
    height = _TOP + len(drawing.panels) * (_PANEL + _GAP) + 30
    stamps = np.concatenate([t for panel in drawing.panels for t, _ in panel.curves])
    begins, lasts = float(stamps.min()), float(np.ptp(stamps))
    scale = (_WIDTH - _LEFT - _RIGHT) / lasts
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" '
        'font-family="sans-serif" font-size="12">',
        f"<title>{drawing.title}</title>",
        _text(_LEFT, 18, drawing.title, _GREY),
        *(
            _text(_LEFT + 340 + 80 * n, 18, name, (_FIRST, _SECOND)[n])
            for n, name in enumerate(drawing.legend)
        ),
        *(part for n, panel in enumerate(drawing.panels) for part in _panel(n, panel, begins, scale)),
        *_marks(drawing.marks, begins, scale, height),
        *_seconds(lasts, scale, height),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _errors_of(trace: Trace) -> Sequence[tuple[FloatArray, FloatArray]]:
    return [(trace.t, trace.measured - flown) for flown in (trace.before, trace.after)]


def _panel(n: int, panel: Panel, begins: float, scale: float) -> Iterator[str]:
    name, unit, factor = _UNITS[panel.channel]
    values = np.concatenate([factor * y for _, y in panel.curves])
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    top = _TOP + n * (_PANEL + _GAP)

    def place(value: FloatArray | float) -> FloatArray | float:
        return top + _PANEL * (high - value) / (high - low)

    if panel.half_band:
        band = min(factor * panel.half_band, high, -low)
        yield (
            f'<rect x="{_LEFT}" y="{place(band):.1f}" width="{_WIDTH - _LEFT - _RIGHT}" '
            f'height="{place(-band) - place(band):.1f}" fill="{_GREY}" opacity="0.25"/>'
        )
    yield _line(_LEFT, float(place(0.0)), _WIDTH - _RIGHT, float(place(0.0)))
    yield _text(8, top + _PANEL / 2 + 4, f"{name}, {unit}", _GREY)
    for value, y in ((high, top + 10), (low, top + _PANEL)):
        yield _text(_LEFT - 38, y, f"{value:+.2g}".replace("-", "−"), _GREY)
    for (t, y), colour in zip(panel.curves, (_FIRST, _SECOND), strict=False):
        yield _curve(_LEFT + (t - begins) * scale, np.asarray(place(factor * y)), colour)


def _marks(marks: Mapping[str, float], begins: float, scale: float, height: int) -> Iterator[str]:
    for name, stamp in marks.items():
        x = _LEFT + (stamp - begins) * scale
        yield _line(x, _TOP, x, height - 30)
        yield _text(x - 4 - 6 * len(name), _TOP + _PANEL + 11, name, _GREY)


def _seconds(lasts: float, scale: float, height: int) -> Iterator[str]:
    for second in range(0, int(lasts) + 1, 2):
        yield _text(_LEFT + second * scale, height - 12, f"{second} s", _GREY)


def _curve(x: FloatArray, y: FloatArray, colour: str) -> str:
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.3"/>'


def _line(*ends: float) -> str:
    x1, y1, x2, y2 = (f"{end:.1f}" for end in ends)
    return f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{_GREY}" stroke-width="0.5"/>'


def _text(x: float, y: float, text: str, colour: str) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" fill="{colour}">{text}</text>'
