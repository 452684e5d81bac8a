"""Air speed inside a manoeuvre, from a slow, late sensor and the accelerometers.

Air speed samples arrive a few times per second, filtered and late (0.3 s on an ArduPlane). Within a 3-2-1-1
the air speed changes by metres per second. The rate of the air speed follows from the motion alone,

    V̇ = a_x·cos α + a_z·sin α - g·sin(θ - α)

in still air. The integral gives the shape; the sensor gives level, drift and delay. If the sensor disagrees
with the motion, as in gusts, the sensor is used.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S, integrated, speed_rate_at
from advisor.flight.signals.record import Channel
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

LONGEST_LAG_S = 0.6
LAG_STEP_S = 0.02
SMALLEST_GAIN = 0.3
"""Least share of the disagreement's power between sensor and motion that a lag must remove."""
LARGEST_DISAGREEMENT = 0.03
"""Largest disagreement of sensor and motion, over the mean speed, at which both are used."""
FEWEST_SAMPLES = 8
MOTION = ("a_x", "a_z", "theta", "alpha")


@dataclass(frozen=True, slots=True)
class Airspeed:
    """Air speed over time, and its source."""

    signal: Signal
    """Air speed V over time, m/s."""
    lag_s: float
    """Delay of the air speed sensor, s; 0 if the delay cannot be estimated."""
    smooth: bool
    """Whether the shape comes from the accelerometers instead of the sensor."""


def airspeed(channels: Mapping[str, Channel]) -> Airspeed | None:
    """Return the air speed of a manoeuvre; None if it was not measured or is implausible."""
    measured = channels.get("airspeed")
    if measured is None or len(measured) < 2 or not np.all(np.isfinite(measured.y)):
        return None
    if np.min(measured.y) <= SLOWEST_FLIGHT_M_S:
        return None
    plain = Airspeed(Signal(measured.t, measured.y), 0.0, False)
    if any(name not in channels or len(channels[name]) < FEWEST_SAMPLES for name in MOTION):
        return plain
    t = channels["theta"].t
    shape = integrated(t, speed_rate_at(t, channels))
    inside = (measured.t >= t[0] + LONGEST_LAG_S) & (measured.t <= t[-1])
    if np.count_nonzero(inside) < FEWEST_SAMPLES:
        return plain
    lags = np.arange(0.0, LONGEST_LAG_S + LAG_STEP_S / 2.0, LAG_STEP_S)
    levels, drifts, left = _joined(measured.t[inside], measured.y[inside], t, shape, lags)
    best = int(np.argmin(left))
    if left[best] > (1.0 - SMALLEST_GAIN) * left[0] or best == len(lags) - 1:
        best = 0
    level, drift = levels[best], drifts[best]
    if np.sqrt(left[best]) > LARGEST_DISAGREEMENT * level:
        return plain
    return Airspeed(Signal(t, shape + level + drift * (t - t[0])), float(lags[best]), True)


def _joined(
    t: FloatArray, y: FloatArray, grid: FloatArray, shape: FloatArray, lags: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return level and drift that fit shape and sensor, and the residual mean square, for each lag."""
    late = t - lags[:, None]
    side = y - np.interp(late, grid, shape)
    since = late - grid[0]
    middle, mean = since.mean(axis=1, keepdims=True), side.mean(axis=1, keepdims=True)
    drift = np.sum((since - middle) * (side - mean), axis=1) / np.sum((since - middle) ** 2, axis=1)
    level = mean[:, 0] - drift * middle[:, 0]
    left = np.mean((side - level[:, None] - drift[:, None] * since) ** 2, axis=1)
    return level, drift, left
