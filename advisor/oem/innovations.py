"""Innovations of residuals: a Kalman filter of moving air and coloured instruments.

About a simulated flight the model is linear:

    δα̇ = Z_α (δα + η) + (1 + Z_q) δq,   δq̇ = M_α (δα + η) + M_q δq,   δθ̇ = δq,   η̇ = −η/T_g + white

with η the gust angle w/V, and for each sensor a first-order noise of its own above its white one
(Jategaonkar, *Flight Vehicle System Identification*, chapter 5). The gains depend on times and noise only,
so they are found once; residuals and sensitivities then pass through the same filter, and least
squares of what comes out is the best that can be done with such noise.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from advisor.flight.messages import FloatArray

STATES = 8
CHANNELS = ("alpha", "q", "a_z", "theta")
ALPHA, Q, A_Z, THETA = range(4)
DIFFUSE = 1e3
"""Variance of a motion of which nothing is known at the start of the record."""


@dataclass(frozen=True)
class AirModel:
    """Noise of the instruments and motion of the air, as standard deviations in SI."""

    white: FloatArray
    """Shape (4,): white noise of α, q, a_z, θ."""
    coloured: FloatArray
    """Shape (4,): noise with memory, by channel."""
    memory_s: float
    """Of the coloured noise."""
    gust: float
    """Of the gust angle w/V, rad; 0 for still air."""
    gust_memory_s: float
    seen_by_alpha: float = 1.0
    """1 when the α channel reads the air (a vane), 0 when it is made from inertial sensors."""


@dataclass(frozen=True)
class Gains:
    """A filter made ready for one record."""

    step: FloatArray
    """Shape (n, 4, 4): transition of α, q, θ and the gust up to each row."""
    keep: FloatArray
    """Shape (n,): what is left of the coloured noise since the row before."""
    gain: FloatArray
    """Shape (n, 8)."""
    root: FloatArray
    """Shape (n,): standard deviation of each innovation."""
    channel: np.ndarray
    observed: FloatArray
    """Shape (4, 8): how each channel sees the states."""

    def innovations(self, columns: FloatArray, order: np.ndarray | None = None) -> FloatArray:
        """Whitened columns, shape (n, k), in the same order of rows: ``order`` says which come in time."""
        rows = np.arange(len(columns)) if order is None else order
        return np.asarray(
            _pass(self.step, self.keep, self.gain, self.root, self.channel, self.observed, columns, rows)
        )

    def cost(self, left: FloatArray) -> float:
        """-2 log likelihood of a residual, shape (n,), without its constant and without diffuse rows."""
        known = self.root**2 < 0.1 * DIFFUSE
        e = self.innovations(left[:, None])[known, 0]
        return float(2.0 * np.sum(np.log(self.root[known])) + e @ e)


def gains_of(
    t: FloatArray,
    channel: np.ndarray,
    system: FloatArray,
    air: AirModel,
    start_variance: float = DIFFUSE,
    extra: FloatArray | float = 0.0,
    arms_m: tuple[float, float] = (0.0, 0.0),
) -> Gains:
    """Find the gains for rows at times ``t``, ascending, of channels ``channel``, both shape (n,).

    Parameters
    ----------
    system
        Z_α, Z_q, M_α, M_q, V.
    start_variance
        Of α, q and θ at the start; 0 when the fit has initial states of its own.
    extra
        Shape (n,): variance of each row beyond its channel's noise, such as that of an uncertain stamp.
    arms_m
        Of the vane and of the accelerometer, ahead of the centre of gravity.
    """
    white = np.asarray(air.white[channel] ** 2 + extra)
    colour = np.array([*air.coloured, air.memory_s, air.gust, air.gust_memory_s])
    observed = np.zeros((4, STATES))
    z_a, z_q, m_a, m_q, speed = system
    vane, imu = arms_m
    lift, turn = speed * z_a - imu * m_a, speed * z_q - imu * m_q
    observed[ALPHA, [0, 1, 3, 4]] = 1.0, -vane / speed, air.seen_by_alpha, 1.0
    observed[Q, [1, 5]] = 1.0
    observed[A_Z, [0, 1, 3, 6]] = lift, turn, lift, 1.0
    observed[THETA, [2, 7]] = 1.0
    step, keep, gain, root = _gains(t, channel, system, white, colour, observed, start_variance)
    return Gains(step, keep, gain, root, channel, observed)


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _gains(
    t: FloatArray,
    channel: np.ndarray,
    system: FloatArray,
    white: FloatArray,
    colour: FloatArray,
    observed: FloatArray,
    start_variance: float,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    n = len(t)
    steps, keeps = np.empty((n, 4, 4)), np.empty(n)
    gains, roots = np.empty((n, STATES)), np.empty(n)
    z_a, z_q, m_a, m_q = system[0], system[1], system[2], system[3]
    memory, gust, gust_memory = colour[4], colour[5], colour[6]
    A = np.zeros((4, 4))
    A[0, 0], A[0, 1], A[0, 3] = z_a, 1.0 + z_q, z_a
    A[1, 0], A[1, 1], A[1, 3] = m_a, m_q, m_a
    A[2, 1] = 1.0
    step = np.eye(4)
    P = np.zeros((STATES, STATES))
    P[0, 0], P[1, 1], P[2, 2], P[3, 3] = start_variance, start_variance, start_variance, gust * gust
    for c in range(4):
        P[4 + c, 4 + c] = colour[c] ** 2
    moved, Ph = np.empty((4, STATES)), np.empty(STATES)
    last, keep_gust, keep = -1.0, 1.0, 1.0
    for i in range(n):
        dt = t[i] - t[i - 1] if i > 0 else 0.0
        if dt > 1e-9:
            if abs(dt - last) > 1e-9:
                last = dt
                keep_gust, keep = np.exp(-dt / gust_memory), np.exp(-dt / memory)
                for a in range(4):
                    for b in range(4):
                        square = 0.0
                        for s in range(4):
                            square += A[a, s] * A[s, b]
                        step[a, b] = (1.0 if a == b else 0.0) + A[a, b] * dt + square * 0.5 * dt * dt
                step[3, 3] = keep_gust
            steps[i], keeps[i] = step, keep
            for a in range(4):
                for b in range(STATES):
                    moved[a, b] = (step[a, 0] * P[0, b] + step[a, 1] * P[1, b]
                                   + step[a, 2] * P[2, b] + step[a, 3] * P[3, b])  # fmt: skip
            for a in range(4):
                for b in range(4):
                    P[a, b] = (moved[a, 0] * step[b, 0] + moved[a, 1] * step[b, 1]
                               + moved[a, 2] * step[b, 2] + moved[a, 3] * step[b, 3])  # fmt: skip
                for b in range(4, STATES):
                    P[a, b] = moved[a, b] * keep
                    P[b, a] = P[a, b]
            for a in range(4, STATES):
                for b in range(4, STATES):
                    P[a, b] *= keep * keep
            fresh = gust * gust * (1.0 - keep_gust * keep_gust)
            P[3, 3] += fresh
            # The gust that arises within the step already acts on the states, for half of it.
            for a in range(2):
                P[a, 3] += 0.5 * step[a, 3] * fresh
                P[3, a] += 0.5 * step[a, 3] * fresh
                for b in range(2):
                    P[a, b] += 0.25 * step[a, 3] * step[b, 3] * fresh
            for c in range(4):
                P[4 + c, 4 + c] += colour[c] ** 2 * (1.0 - keep * keep)
        else:
            steps[i], keeps[i] = np.eye(4), 1.0
        c = channel[i]
        Ph[:] = 0.0
        for s in range(STATES):
            seen = observed[c, s]
            if seen != 0.0:
                for a in range(STATES):
                    Ph[a] += P[s, a] * seen
        variance = white[i]
        for s in range(STATES):
            variance += observed[c, s] * Ph[s]
        roots[i] = np.sqrt(variance)
        per_variance = 1.0 / variance
        for a in range(STATES):
            gain = Ph[a] * per_variance
            gains[i, a] = gain
            for b in range(STATES):
                P[a, b] -= gain * Ph[b]
    return steps, keeps, gains, roots


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _pass(
    steps: FloatArray,
    keeps: FloatArray,
    gains: FloatArray,
    roots: FloatArray,
    channel: np.ndarray,
    observed: FloatArray,
    columns: FloatArray,
    rows: np.ndarray,
) -> FloatArray:
    n, k = columns.shape
    out = np.empty((n, k))
    X = np.zeros((STATES, k))
    innovation = np.empty(k)
    for i in range(n):
        if keeps[i] < 1.0:
            s = steps[i]
            for j in range(k):
                a, q, angle, air = X[0, j], X[1, j], X[2, j], X[3, j]
                X[0, j] = s[0, 0] * a + s[0, 1] * q + s[0, 3] * air
                X[1, j] = s[1, 0] * a + s[1, 1] * q + s[1, 3] * air
                X[2, j] = angle + s[2, 0] * a + s[2, 1] * q + s[2, 3] * air
                X[3, j] = s[3, 3] * air
            for c in range(4, STATES):
                for j in range(k):
                    X[c, j] *= keeps[i]
        c, row, per_root = channel[i], rows[i], 1.0 / roots[i]
        for j in range(k):
            innovation[j] = columns[row, j]
        for s in range(STATES):
            seen = observed[c, s]
            if seen != 0.0:
                for j in range(k):
                    innovation[j] -= seen * X[s, j]
        for s in range(STATES):
            gain = gains[i, s]
            for j in range(k):
                X[s, j] += gain * innovation[j]
        for j in range(k):
            out[row, j] = innovation[j] * per_root
    return out
