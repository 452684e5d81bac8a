"""Text on the size of the gap by phase, frequency and manoeuvre, on the worst manoeuvre, and on fidelity
measures.
"""

from collections.abc import Iterator, Sequence
from itertools import zip_longest

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from advisor.gap.result import Diagnosis, Gap, Trace, Yardsticks
from advisor.process.arrays import FloatArray
from advisor.report.facts.sizes import before_after, short
from advisor.words.quantities import CHANNELS

_TICKS = "▁▂▃▄▅▆▇█"
_LEGEND = (
    "Theil: below 0.25 is called acceptable. Of error, after: per cent bias/variance/covariance. "
    "Band: q ±2 deg/s, θ ±1.5 deg, a_z ±0.10 g."
)
_BESIDE_BARS = 34
"""Number of columns for the letters before the bars and for the numbers after the bars."""


def errors(d: Diagnosis, width: int) -> Text:
    """Return the largest errors during the manoeuvre with the largest gap, with one scale per channel."""
    worst = worst_maneuver(d)
    lines = [line for t in d.traces if t.number == worst for line in _pair(t, max(width - _BESIDE_BARS, 10))]
    return Text("\n".join(lines) or "no traces", no_wrap=True, overflow="crop")


def worst_maneuver(d: Diagnosis) -> int:
    """Return the number of the manoeuvre with the largest gap."""
    return max(d.gap.by_maneuver, key=lambda row: row[1])[0]


def peaks(traces: Sequence[Trace]) -> str:
    """Return the largest errors in units for engineers: ``peak error of q 10 → 0.7 deg/s, of α 3 → 0.4 deg``.

    The errors are taken over all held-out manoeuvres.
    """
    said = []
    for channel in dict.fromkeys(t.channel for t in traces):
        quantity, mine = CHANNELS[channel], [t for t in traces if t.channel == channel]
        before, after = (
            quantity.factor * max(float(np.max(np.abs(t.measured - getattr(t, name)))) for t in mine)
            for name in ("before", "after")
        )
        said.append(f"{quantity.symbol} {before:.2g} → {after:.2g} {quantity.unit}")
    return f"peak error of {', of '.join(said)}"


def yardsticks(d: Diagnosis) -> Iterator[RenderableType]:
    """Yield gap, Theil's coefficient with its parts, R² and the share within the qualification tolerance."""
    yield Text("fidelity on held-out manoeuvres, before → after", style="bold")
    yield _yardsticks(d)
    if d.yardsticks:
        yield Text(_LEGEND, style="dim")


def _yardsticks(d: Diagnosis) -> Table:
    # One column of padding, not two: with the largest possible numbers the table fills 80 columns.
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for heading in ("", "gap", *(("Theil", "of error", "R²", "in band, %") if d.yardsticks else ())):
        table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for channel, given in d.gap.by_channel.items():
        cells = [CHANNELS[channel].symbol, before_after(given, d.gap.by_channel_after[channel])]
        if channel in d.yardsticks:
            cells += _measures(*d.yardsticks[channel])
        table.add_row(*cells)
    return table


def _measures(before: Yardsticks, after: Yardsticks) -> list[str]:
    inside = "" if after.within_tolerance is None or before.within_tolerance is None else (
        f"{100 * before.within_tolerance:.0f} → {100 * after.within_tolerance:.0f}"
    )  # fmt: skip
    split = "/".join(f"{100 * share:.0f}" for share in (after.bias, after.variance, after.covariance))
    return [
        f"{before.theil:.3f} → {after.theil:.3f}", split, f"{before.r2:.4f} → {after.r2:.4f}", inside,
    ]  # fmt: skip


def _pair(trace: Trace, width: int) -> tuple[str, str]:
    quantity = CHANNELS[trace.channel]
    before, after = (quantity.factor * np.abs(trace.measured - y) for y in (trace.before, trace.after))
    top = max(float(np.max(before)), float(np.max(after)), 1e-12)
    return (
        f"{quantity.symbol:>4s} before {_bars(before, top, width)}  {_peak(before)} {quantity.unit}",
        f"     after  {_bars(after, top, width)}  {_peak(after)} {quantity.unit}",
    )


def _peak(error: FloatArray) -> str:
    return f"peak {float(np.max(error)):.2g}"


def _bars(error: FloatArray, top: float, width: int) -> str:
    parts = np.array_split(error, max(min(width, len(error)), 1))
    return "".join(_TICKS[min(int(8 * float(np.max(p)) / top), 7)] for p in parts)


_BAR = 12
_EIGHTHS = "▏▎▍▌▋▊▉"
_AS_LOUD_AS_NOISE = 1.0
"""Least gap that fills a bar. A smaller gap must not look large."""
_LEFT = 38
"""Number of columns for the text left of the bars."""


def whereabouts(gap: Gap) -> Text:
    """Return bars of the gap by phase and by frequency side by side, then bars of every manoeuvre before and
    after.
    """
    beside = [*_beside(list(_phases(gap)), list(_bands(gap))), ""] if gap.by_phase or gap.by_band_hz else []
    lines = [*beside, *_maneuvers(gap)]
    return Text("\n".join(lines), no_wrap=True, overflow="crop")


def _phases(gap: Gap) -> Iterator[str]:
    yield "gap by phase, before"
    largest = max(gap.by_phase.values(), default=0.0)
    for phase, value in gap.by_phase.items():
        yield f"{phase:14s}{short(value):>8s} {_gap_bar(value, largest)}"


def _bands(gap: Gap) -> Iterator[str]:
    yield "power of the error of q, before"
    for low, high, share in gap.by_band_hz:
        band = f"{low:g} to {high:g} Hz"
        yield f"{band:>11s}{100.0 * share:4.0f} % {_bar(share)}"


def _maneuvers(gap: Gap) -> Iterator[str]:
    yield "gap by manoeuvre, before → after"
    largest = max((before for _, before, _ in gap.by_maneuver), default=0.0)
    cells = [
        f"{number:3d} {_gap_bar(before, largest):{_BAR}s} {before_after(before, after)}"
        for number, before, after in gap.by_maneuver
    ]
    half = (len(cells) + 1) // 2
    yield from _beside(cells[:half], cells[half:])


def _beside(left: list[str], right: list[str]) -> Iterator[str]:
    for line, other in zip_longest(left, right, fillvalue=""):
        yield f"{line:{_LEFT}s}{other}".rstrip()


def _gap_bar(value: float, largest: float) -> str:
    return _bar(value / max(largest, _AS_LOUD_AS_NOISE))


def _bar(share: float) -> str:
    full, eighths = divmod(round(8 * _BAR * share), 8)
    return "█" * full + _EIGHTHS[:eighths][-1:]
