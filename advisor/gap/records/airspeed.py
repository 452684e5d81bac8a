"""Air speed during a manoeuvre, from a slow, noisy sensor and the accelerometers.

V̇ = a_x cos α + a_z sin α − g sin γ is integrated. A parabola in time, fitted to the measured air speed,
removes the drift of the integral. The air speed sensor gives the level, and the accelerometers give the
shape.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S, integrated, speed_rate_at
from advisor.oem.airspeed import LARGEST_DISAGREEMENT
from advisor.process.arrays import FloatArray

STEP_S = 0.005
"""Numerical: step of the time grid, s: a hundredth of the fastest short period, and the resolution of
stamps."""


def smooth(y: FloatArray, seconds: float) -> FloatArray:
    """Return the centred moving average of a series on the time grid, over ``seconds``, shape (n,)."""
    width = max(1, round(seconds / STEP_S)) | 1
    padded = np.pad(y, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


_LEAST_SAMPLES = 6
"""Record: least number of air speed samples in a manoeuvre for the fit of a parabola. With fewer samples the
smoothed air speed is used."""
_LEAST_SPARE = 10
"""Record: least number of samples in all manoeuvres, minus three for each manoeuvre's parabola, for an
estimate of the instrument's noise."""
_LONGEST_MEMORY = 0.95
"""Prior: largest correlation between successive samples that the air speed sensor may cause. A higher
correlation is motion of the aircraft."""
_READ_OVER_S = 0.5
"""Numerical: length in s of the air speed's moving average if no accelerometer is available."""
_SLOW_S = 1.0
"""Numerical: length in s of the moving average of thrust minus drag, against accelerometer noise."""


def measures_speed(maneuver: Maneuver) -> bool:
    """Return whether the manoeuvre has a plausible air speed; a pitot tube may be missing or covered."""
    speed = maneuver.channels.get("airspeed")
    if speed is None or speed.provenance == "given":
        return False
    return len(speed) > 1 and float(np.min(speed.y)) > SLOWEST_FLIGHT_M_S


def airspeed_on(
    grid: FloatArray, maneuver: Maneuver, start_s: float, true_over_read: float = 1.0
) -> FloatArray:
    """Return the air speed as the sensor reads it, m/s, shape (n,), at ``grid`` seconds after ``start_s``.

    Accelerometers show the change of the true air speed, which is ``true_over_read`` times the sensor's
    reading.
    """
    channels = maneuver.channels
    t, y = channels["airspeed"].t - start_s, channels["airspeed"].y
    as_read = smooth(np.interp(grid, t, y), _READ_OVER_S)
    if not all(name in channels and len(channels[name]) > 10 for name in ("a_x", "a_z", "theta", "alpha")):
        return as_read
    shape = integrated(grid, speed_rate_at(grid + start_s, channels)) / true_over_read
    inside = (t >= grid[0]) & (t <= grid[-1])
    if np.count_nonzero(inside) < _LEAST_SAMPLES:
        return as_read
    drift = np.polyfit(t[inside], y[inside] - np.interp(t[inside], grid, shape), 2)
    rebuilt = shape + np.polyval(drift, grid)
    disagreement = np.std(y[inside] - np.interp(t[inside], grid, rebuilt))
    # An instrument that disagrees with the motion (gusts, wind shear) is preferred to the motion.
    return rebuilt if disagreement < LARGEST_DISAGREEMENT * float(np.mean(y[inside])) else as_read


def speed_error_factors(
    stamps: Sequence[FloatArray], residuals: Sequence[FloatArray], durations_s: Sequence[float]
) -> list[FloatArray]:
    """Return the uncertainty of level, slope and curvature of each manoeuvre's air speed due to sensor noise.

    Parameters
    ----------
    stamps, residuals
        Per manoeuvre, shape (n,): seconds since the start of the record, and the instrument's reading minus
        the smoothed air speed. Size and correlation of the noise are estimated over all manoeuvres.
    durations_s
        Length of each manoeuvre's record, s.

    Returns
    -------
    Per manoeuvre a factor of the covariance of the three coefficients, shape (3, 3), m/s. Time runs from -1
    at the start of the record to 1 at its end. Shape (0, 0) where the samples are too few.
    """
    spare = sum(max(len(e) - 3, 0) for e in residuals)
    power = sum(float(e @ e) for e in residuals)
    if spare < _LEAST_SPARE or power == 0.0:
        return [np.empty((0, 0))] * len(residuals)
    memory = np.clip(sum(float(e[1:] @ e[:-1]) for e in residuals) / power, 0.0, _LONGEST_MEMORY)
    sigma = float(np.sqrt(power / spare * (1.0 + memory) / (1.0 - memory)))
    factors = []
    for t, duration in zip(stamps, durations_s, strict=True):
        parabola = np.vander(2.0 * t / duration - 1.0, 3, increasing=True)
        enough = len(t) >= _LEAST_SAMPLES
        factors.append(sigma * np.linalg.pinv(np.linalg.qr(parabola)[1]) if enough else np.empty((0, 0)))
    return factors


def along_the_path(grid: FloatArray, maneuver: Maneuver, start_s: float) -> FloatArray:
    """Return thrust minus drag over mass, a_x cos α + a_z sin α, m/s², shape (n,); 0 if not measured."""
    channels = maneuver.channels
    if not all(name in channels and len(channels[name]) > 10 for name in ("a_x", "a_z", "alpha")):
        return np.zeros(len(grid))
    t = channels["a_z"].t
    alpha, a_x = (np.interp(t, channels[name].t, channels[name].y) for name in ("alpha", "a_x"))
    along = a_x * np.cos(alpha) + channels["a_z"].y * np.sin(alpha)
    return smooth(np.interp(grid, t - start_s, along), _SLOW_S)
