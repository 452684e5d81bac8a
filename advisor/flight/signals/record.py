"""Channels: physical quantities with units, each with separate stamps on the vehicle's clock."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.process.arrays import FloatArray

# Channels that the advisor knows, with SI units. Alpha, pitch rate and pitch are positive nose up; elevator
# is positive trailing edge down; body z points down. Sideslip is positive with wind from the right. A
# positive aileron rolls to the left, a positive rudder yaws to the left.
UNITS = {
    "elevator": "rad",
    "aileron": "rad",
    "rudder": "rad",
    "throttle": "1",
    "alpha": "rad",
    "beta": "rad",
    "q": "rad/s",
    "p": "rad/s",
    "r": "rad/s",
    "theta": "rad",
    "bank": "rad",
    "a_x": "m/s^2",
    "a_y": "m/s^2",
    "a_z": "m/s^2",
    "airspeed": "m/s",
    "climb_rate": "m/s",
    "height": "m",
}
AIR_UNITS = {"altitude": "m", "static_pressure": "Pa"}
"""Units of the channels that are used only for the air density. The altitude is above mean sea level."""
WIND_UNITS = {"wind_along": "m/s", "wind_right": "m/s"}
"""Units of the wind along the aircraft's heading and to its right."""
ALL_UNITS = UNITS | AIR_UNITS | WIND_UNITS
"""Unit of every channel in a manoeuvre or a whole flight, by the channel's name."""


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """One physical quantity over time. A gap is a longer interval between stamps, because samples are never
    resampled."""

    name: str
    t: FloatArray
    """Shape (n,): strictly increasing stamps, s since boot."""
    y: FloatArray
    """Shape (n,): values, SI."""
    source: str = ""
    """Message and field of the channel, e.g. ``AOA_SSA.AOA``."""
    provenance: str = "unknown"
    """Kind of origin: ``vane``, ``derived``, ``simulated``, ``measured``, ``commanded`` or ``unknown``."""
    delay_s: float = 0.0
    """Known delay of the values relative to their stamps, s, such as that of an autopilot's filter."""
    gain: float = 1.0
    """Mean factor from the logged values to these values, such as from indicated to true air speed."""

    def __len__(self) -> int:
        return len(self.t)

    def cut(self, start_s: float, end_s: float) -> "Channel":
        """Return the samples with ``start_s <= t <= end_s``."""
        i, j = np.searchsorted(self.t, [start_s, np.nextafter(end_s, np.inf)])
        return replace(self, t=self.t[i:j], y=self.y[i:j])

    @property
    def rate_hz(self) -> float:
        """Median sampling rate, Hz; NaN with fewer than two samples."""
        return float(1.0 / np.median(np.diff(self.t))) if len(self.t) > 1 else float("nan")

    @property
    def largest_gap_s(self) -> float:
        """Longest time between two stamps, s; infinite with fewer than two samples."""
        return float(np.max(np.diff(self.t))) if len(self.t) > 1 else float("inf")
