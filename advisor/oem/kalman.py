"""Compiled Kalman filter for ``innovations``: covariance, gains, and innovations of residuals.

The states are α, q, θ and the gust angle, then the coloured noise of each channel. Rows are in order of time,
so that every update is scalar.
"""

from typing import NamedTuple

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

STATES = 8
DIFFUSE = 1e3
"""Variance of an unknown initial motion, far above any motion in SI units."""


class Gains(NamedTuple):
    """Kalman gains for one record."""

    step: FloatArray
    """Shape (n, 4, 4): transition of α, q, θ and the gust angle up to each row."""
    keep: FloatArray
    """Shape (n,): factor by which the coloured noise has decayed since the previous row."""
    gain: FloatArray
    """Shape (n, 8): Kalman gain of each row."""
    root: FloatArray
    """Shape (n,): standard deviation of each row's innovation."""
    channel: np.ndarray
    observed: FloatArray
    """Shape (4, 8): observation matrix of α, q, a_z and θ for the eight states."""

    def innovations(self, columns: FloatArray, order: np.ndarray | None = None) -> FloatArray:
        """Return whitened columns, shape (n, k), in their row order; ``order`` gives the rows in order of
        time."""
        rows = np.arange(len(columns)) if order is None else order
        return np.asarray(pass_through(self, columns, rows))


@kernel(error_model="numpy")
def observed_by(system: FloatArray, seen_by_alpha: float, vane_m: float, imu_m: float) -> FloatArray:
    """Return the observation of the states by α, q, a_z and θ, shape (4, 8); ``system``, shape (5,), is Z_α,
    Z_q, M_α, M_q, V."""
    z_a, z_q, m_a, m_q, speed = system[0], system[1], system[2], system[3], system[4]
    lift = speed * z_a - imu_m * m_a
    observed = np.zeros((4, STATES))
    observed[0, 0], observed[0, 1], observed[0, 3] = 1.0, -vane_m / speed, seen_by_alpha
    observed[1, 1], observed[3, 2] = 1.0, 1.0
    observed[2, 0], observed[2, 1], observed[2, 3] = lift, speed * z_q - imu_m * m_q, lift
    for c in range(4):
        observed[c, 4 + c] = 1.0
    return observed


@kernel(error_model="numpy", fastmath={"contract"})
def _begun(
    system: FloatArray, memory: FloatArray, start_variance: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the matrix of α, q, θ and gust angle, half its square, and the initial covariance, shape (8,
    8)."""
    z_a, z_q, m_a, m_q = system[0], system[1], system[2], system[3]
    A, P = np.zeros((4, 4)), np.zeros((STATES, STATES))
    A[0, 0], A[0, 1], A[0, 3] = z_a, 1.0 + z_q, z_a
    A[1, 0], A[1, 1], A[1, 3] = m_a, m_q, m_a
    A[2, 1] = 1.0
    P[0, 0], P[1, 1], P[2, 2], P[3, 3] = start_variance, start_variance, start_variance, memory[5] ** 2
    for c in range(4):
        P[4 + c, 4 + c] = memory[c] ** 2
    half_square = np.zeros((4, 4))
    for a in range(4):
        for b in range(4):
            for s in range(4):
                half_square[a, b] += 0.5 * A[a, s] * A[s, b]
    return A, half_square, P


@kernel(error_model="numpy", fastmath={"contract"})
def _transition(
    step: FloatArray, A: FloatArray, half_square: FloatArray, dt: float, keep_gust: float
) -> None:
    """Write the transition of α, q, θ and gust angle over ``dt`` s: second order, exact for the gust."""
    for a in range(4):
        for b in range(4):
            step[a, b] = (A[a, b] + half_square[a, b] * dt) * dt
        step[a, a] += 1.0
    step[3, 3] = keep_gust


@kernel(error_model="numpy", fastmath={"contract"})
def _propagate(
    P: FloatArray, moved: FloatArray, step: FloatArray, keep: float, keep_gust: float, memory: FloatArray
) -> None:
    """Advance the covariance by a step; ``moved``, shape (4, 8), is work space."""
    # No state depends on θ, and the gust depends on itself alone.
    for b in range(STATES):
        a, q, air = P[0, b], P[1, b], P[3, b]
        moved[0, b] = step[0, 0] * a + step[0, 1] * q + step[0, 3] * air
        moved[1, b] = step[1, 0] * a + step[1, 1] * q + step[1, 3] * air
        moved[2, b] = P[2, b] + step[2, 0] * a + step[2, 1] * q + step[2, 3] * air
        moved[3, b] = keep_gust * air
    for a in range(4):
        turned, air = moved[a, 2], moved[a, 3]
        for b in range(3):
            P[a, b] = step[b, 0] * moved[a, 0] + step[b, 1] * moved[a, 1] + step[b, 3] * air
        P[a, 2] += turned
        P[a, 3] = keep_gust * air
        for b in range(4, STATES):
            P[a, b] = moved[a, b] * keep
            P[b, a] = P[a, b]
    for a in range(4, STATES):
        for b in range(4, STATES):
            P[a, b] *= keep * keep
    fresh = memory[5] ** 2 * (1.0 - keep_gust * keep_gust)
    P[3, 3] += fresh
    # The gust that arises within the step already acts on the states for half of it.
    for a in range(2):
        P[a, 3] += 0.5 * step[a, 3] * fresh
        P[3, a] += 0.5 * step[a, 3] * fresh
        for b in range(2):
            P[a, b] += 0.25 * step[a, 3] * step[b, 3] * fresh
    for c in range(4):
        P[4 + c, 4 + c] += memory[c] ** 2 * (1.0 - keep * keep)


@kernel(error_model="numpy", fastmath={"contract"})
def _correct(P: FloatArray, gain: FloatArray, observed: FloatArray, white: float) -> float:
    """Update the covariance with a row; return the innovation's variance, and write ``gain``, shape (8,)."""
    gain[:] = 0.0
    for s in range(STATES):
        seen = observed[s]
        if seen != 0.0:
            for a in range(STATES):
                gain[a] += P[s, a] * seen
    variance = white
    for s in range(STATES):
        variance += observed[s] * gain[s]
    per_variance = 1.0 / variance
    for a in range(STATES):
        share = gain[a] * per_variance
        for b in range(STATES):
            P[a, b] -= share * gain[b]
    for a in range(STATES):
        gain[a] *= per_variance
    return variance


@kernel(error_model="numpy", fastmath={"contract"})
def filter_along(
    t: FloatArray,
    system: FloatArray,
    white: FloatArray,
    memory: FloatArray,
    start_variance: float,
    residual: FloatArray,
    gains: Gains,
) -> float:
    """Run the filter along a record, and return -2 log likelihood of the residual.

    Parameters
    ----------
    t
        Shape (n,): ascending times.
    system
        Shape (5,): Z_α, Z_q, M_α, M_q, V.
    white
        Shape (n,): variance of each row's white noise.
    memory
        Shape (7,): standard deviations of the coloured noise by channel and its correlation time in s, then
        that of the gust angle in rad, and its correlation time in s.
    start_variance
        Variance of α, q and θ at the start.
    residual
        Shape (n,): residual, or (0,) for none.
    gains
        Arrays of n rows that receive the gains, or of no rows.

    Returns
    -------
    Up to a constant, without rows that are still diffuse; 0 without a residual.
    """
    seeking, keeping = len(residual) > 0, len(gains.root) > 0
    A, half_square, P = _begun(system, memory, start_variance)
    step, still, moved = np.eye(4), np.eye(4), np.empty((4, STATES))
    x, gain = np.zeros(STATES), np.empty(STATES)
    last, keep_gust, keep, cost = -1.0, 1.0, 1.0, 0.0
    for i in range(len(t)):
        dt = t[i] - t[i - 1] if i > 0 else 0.0
        later = dt > 1e-9
        if later:
            if abs(dt - last) > 1e-9:
                last, keep_gust, keep = dt, np.exp(-dt / memory[6]), np.exp(-dt / memory[4])
                _transition(step, A, half_square, dt, keep_gust)
            _propagate(P, moved, step, keep, keep_gust, memory)
        seen = gains.observed[gains.channel[i]]
        variance = _correct(P, gain, seen, white[i])
        if keeping:
            gains.step[i], gains.keep[i] = step if later else still, keep if later else 1.0
            gains.gain[i], gains.root[i] = gain, np.sqrt(variance)
        if seeking:
            if later:
                _advance(x, step, keep, keep_gust)
            innovation = residual[i]
            for s in range(STATES):
                innovation -= seen[s] * x[s]
            for s in range(STATES):
                x[s] += gain[s] * innovation
            if variance < 0.1 * DIFFUSE:
                cost += np.log(variance) + innovation * innovation / variance
    return cost


@kernel(error_model="numpy", fastmath={"contract"})
def _advance(x: FloatArray, step: FloatArray, keep: float, keep_gust: float) -> None:
    """Advance the states, shape (8,), by a step."""
    a, q, air = x[0], x[1], x[3]
    x[0] = step[0, 0] * a + step[0, 1] * q + step[0, 3] * air
    x[1] = step[1, 0] * a + step[1, 1] * q + step[1, 3] * air
    x[2] += step[2, 0] * a + step[2, 1] * q + step[2, 3] * air
    x[3] = keep_gust * air
    for s in range(4, STATES):
        x[s] *= keep


@kernel(error_model="numpy", fastmath={"contract"})
def pass_through(gains: Gains, columns: FloatArray, rows: np.ndarray) -> FloatArray:
    """Return the innovations of columns, shape (n, k), in units of each innovation's standard deviation.

    ``rows``, shape (n,), holds the columns' row indices in order of time.
    """
    n, k = columns.shape
    out = np.empty((n, k))
    X = np.zeros((STATES, k))
    innovation = np.empty(k)
    for i in range(n):
        if gains.keep[i] < 1.0:
            s = gains.step[i]
            for j in range(k):
                a, q, angle, air = X[0, j], X[1, j], X[2, j], X[3, j]
                X[0, j] = s[0, 0] * a + s[0, 1] * q + s[0, 3] * air
                X[1, j] = s[1, 0] * a + s[1, 1] * q + s[1, 3] * air
                X[2, j] = angle + s[2, 0] * a + s[2, 1] * q + s[2, 3] * air
                X[3, j] = s[3, 3] * air
            for c in range(4, STATES):
                for j in range(k):
                    X[c, j] *= gains.keep[i]
        c, row, per_root = gains.channel[i], rows[i], 1.0 / gains.root[i]
        for j in range(k):
            innovation[j] = columns[row, j]
        for s in range(STATES):
            seen = gains.observed[c, s]
            if seen != 0.0:
                for j in range(k):
                    innovation[j] -= seen * X[s, j]
        for s in range(STATES):
            gain = gains.gain[i, s]
            for j in range(k):
                X[s, j] += gain * innovation[j]
        for j in range(k):
            out[row, j] = innovation[j] * per_root
    return out
