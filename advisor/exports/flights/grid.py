"""One grid of times for all channels: uniform, at the rate of the pitch rate."""

from collections.abc import Mapping

import numpy as np

from advisor.exports.flights.table import Column, FlightTable
from advisor.flight.maneuvers.segmentation import GAP_S, MANY_INTERVALS
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import ALL_UNITS, Channel

GRID = (
    "uniform, from the first to the last stamp of the pitch rate q at its median interval (without q, of the"
    " fastest channel); linear between a channel's stamps; nothing outside them and in gaps longer than"
    f" {GAP_S:g} s and {MANY_INTERVALS:g} median intervals"
)
"""Description of the grid, and of the interpolation onto the grid."""


def on_one_grid(channels: Mapping[str, Channel]) -> FlightTable:
    """Return all channels at the times of ``GRID``; without rows where no channel has two samples."""
    t = grid_times(channels)
    columns = [
        Column(name, on_grid(c, t), ALL_UNITS[name], f"{name} from {c.source}")
        for name, c in channels.items()
    ]
    time = Column("t_boot_s", t, "s", "vehicle time since power-on")
    return FlightTable("grid", f"All channels on one grid: {GRID}.", (time, *columns))


def grid_times(channels: Mapping[str, Channel]) -> FloatArray:
    """Return the times of the grid, shape (n,), s since power-on."""
    paced = {name: c for name, c in channels.items() if len(c) > 1}
    if not paced:
        return np.empty(0)
    pace = paced.get("q") or min(paced.values(), key=lambda c: float(np.median(np.diff(c.t))))
    step = float(np.median(np.diff(pace.t)))
    times: FloatArray = pace.t[0] + step * np.arange(int((pace.t[-1] - pace.t[0]) / step + 1e-6) + 1)
    return times


def on_grid(channel: Channel, t: FloatArray) -> FloatArray:
    """Return a channel at the times ``t``, shape (n,): linear between its stamps, NaN outside and in its
    gaps."""
    if len(channel) == 0 or len(t) == 0:
        return np.full(len(t), np.nan)
    y = np.interp(t, channel.t, channel.y, left=np.nan, right=np.nan)
    if len(channel) > 1:
        after = np.clip(np.searchsorted(channel.t, t, side="left"), 1, len(channel) - 1)
        apart = channel.t[after] - channel.t[after - 1]
        lost = apart > max(GAP_S, MANY_INTERVALS * float(np.median(np.diff(channel.t))))
        at_stamp = (t == channel.t[after]) | (t == channel.t[after - 1])
        y[lost & ~at_stamp] = np.nan
    return np.asarray(y, dtype=np.float64)
