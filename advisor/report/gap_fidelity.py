"""Size of the gap: the error along the worst manoeuvre, and measures of fidelity, before and after."""

from collections.abc import Iterator, Sequence

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from advisor.flight.signals.messages import FloatArray
from advisor.gap.result import Diagnosis, Trace
from advisor.report.gap_sizes import before_after
from advisor.words.quantities import CHANNELS

_TICKS = "▁▂▃▄▅▆▇█"
_LEGEND = (
    "Theil: below 0.25 is called acceptable. Of error, after: per cent bias/variance/covariance. "
    "Band: q ±2 deg/s, θ ±1.5 deg, a_z ±0.10 g."
)
_BESIDE_BARS = 34
"""Columns used by the letters before the bars and the numbers behind them."""


def errors(d: Diagnosis, width: int) -> Text:
    """Return the largest error along the manoeuvre with the largest gap, with one scale for each channel."""
    worst = worst_maneuver(d)
    lines = [line for t in d.traces if t.number == worst for line in _pair(t, max(width - _BESIDE_BARS, 10))]
    return Text("\n".join(lines) or "no traces", no_wrap=True, overflow="crop")


def worst_maneuver(d: Diagnosis) -> int:
    """Return the number of the manoeuvre with the largest gap."""
    return max(d.gap.by_maneuver, key=lambda row: row[1])[0]


def peaks(traces: Sequence[Trace]) -> str:
    """Return the largest errors in an engineer's units: ``peak error of q 10 → 0.7 deg/s, of α 3 → 0.4 deg``.

    Every held-out manoeuvre counts.
    """
    said = []
    for channel in dict.fromkeys(t.channel for t in traces):
        quantity, mine = CHANNELS[channel], [t for t in traces if t.channel == channel]
        before, after = (
            quantity.factor * max(float(np.max(np.abs(t.measured - getattr(t, name)))) for t in mine)
            for name in ("before", "after")
        )
        said.append(f"{quantity.symbol} {before:.2g} → {after:.2g} {quantity.unit}")
    return f"peak error of {', of '.join(said)}" if said else ""


def yardsticks(d: Diagnosis) -> Iterator[RenderableType]:
    """Yield gap, Theil's coefficient with its parts, R² and the share inside the qualification's band."""
    yield Text("fidelity on held-out manoeuvres, before → after", style="bold")
    yield _yardsticks(d)
    yield Text(_LEGEND, style="dim")


def _yardsticks(d: Diagnosis) -> Table:
    # One column of padding, not two: with the largest possible numbers the table fills 80 columns.
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for heading in ("", "gap", "Theil", "of error", "R²", "in band, %"):
        table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for channel, (before, after) in d.yardsticks.items():
        inside = "" if after.within_tolerance is None or before.within_tolerance is None else (
            f"{100 * before.within_tolerance:.0f} → {100 * after.within_tolerance:.0f}"
        )  # fmt: skip
        split = "/".join(f"{100 * share:.0f}" for share in (after.bias, after.variance, after.covariance))
        table.add_row(
            CHANNELS[channel].symbol,
            before_after(d.gap.by_channel[channel], d.gap.by_channel_after[channel]),
            f"{before.theil:.3f} → {after.theil:.3f}", split, f"{before.r2:.4f} → {after.r2:.4f}", inside,
        )  # fmt: skip
    return table


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
