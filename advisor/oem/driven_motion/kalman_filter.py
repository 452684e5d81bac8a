"""Compiled Kalman filter of a linear motion that white noise drives, measured with coloured noise.

The states of the motion come first, then one state for the coloured noise of each output. Rows are in order
of time, so that every update is scalar.
"""

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

_LONGEST = 0.25
"""Numerical: largest product of a rate of the motion and a time step for a series of third order."""


@kernel(error_model="numpy", fastmath={"contract"})
def _over(dt: float, matrix: FloatArray, drive: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the transition over ``dt`` s, and the covariance that the drive adds, each of shape (s, s).

    Short steps use a series, and each doubling joins two equal steps.
    """
    n = len(drive)
    fastest = 0.0
    for a in range(n):
        fastest = max(fastest, np.sqrt(np.max(np.abs(matrix[a])) * np.max(np.abs(matrix[:, a]))))
    doublings = 0
    while fastest * dt > _LONGEST * 2.0**doublings and doublings < 30:
        doublings += 1
    short = dt / 2.0**doublings
    square = matrix @ matrix
    step = np.eye(n) + matrix * short + square * (0.5 * short**2) + square @ matrix * (short**3 / 6.0)
    half = np.eye(n) + matrix * (0.5 * short) + square * (0.125 * short**2)
    fresh = (half * (drive * short)) @ half.T
    for _ in range(doublings):
        fresh = fresh + step @ fresh @ step.T
        step = step @ step
    return step, fresh


@kernel(error_model="numpy", fastmath={"contract"})
def _propagate(
    P: FloatArray, moved: FloatArray, step: FloatArray, fresh: FloatArray, keep: float, coloured: FloatArray
) -> None:
    """Advance the covariance by a step; ``moved``, shape (s, s + o), is work space."""
    s, n = len(step), len(P)
    for a in range(s):
        for b in range(n):
            total = 0.0
            for c in range(s):
                total += step[a, c] * P[c, b]
            moved[a, b] = total
    for a in range(s):
        for b in range(a + 1):
            total = fresh[a, b]
            for c in range(s):
                total += moved[a, c] * step[b, c]
            P[a, b] = P[b, a] = total
        for b in range(s, n):
            P[a, b] = P[b, a] = keep * moved[a, b]
    for a in range(s, n):
        for b in range(s, n):
            P[a, b] *= keep * keep
        P[a, a] += coloured[a - s] ** 2 * (1.0 - keep * keep)


@kernel(error_model="numpy", fastmath={"contract"})
def _advance(X: FloatArray, turned: FloatArray, step: FloatArray, keep: float) -> None:
    """Advance the expected states of each column by a step; ``turned``, shape (s, k), is work space."""
    s, k = turned.shape
    for a in range(s):
        for j in range(k):
            total = 0.0
            for b in range(s):
                total += step[a, b] * X[b, j]
            turned[a, j] = total
    X[:s] = turned
    X[s:] *= keep


@kernel(error_model="numpy", fastmath={"contract"})
def _seen(P: FloatArray, gain: FloatArray, seen: FloatArray, own: int) -> float:
    """Return the variance of an output without its white noise; write the covariance of the states with it.

    ``own`` is the state of the output's coloured noise.
    """
    for a in range(len(gain)):
        total = P[a, own]
        for b in range(len(seen)):
            total += P[a, b] * seen[b]
        gain[a] = total
    variance = gain[own]
    for b in range(len(seen)):
        variance += seen[b] * gain[b]
    return float(variance)


@kernel(error_model="numpy", fastmath={"contract"})
def driven_filter(
    lengths: FloatArray,
    kind: np.ndarray,
    channel: np.ndarray,
    matrix: FloatArray,
    seen: FloatArray,
    begun: FloatArray,
    drive: FloatArray,
    white: FloatArray,
    coloured: FloatArray,
    memory_s: float,
    columns: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the innovations of ``columns`` (n, k) over their standard deviations, and these deviations (n,).

    Parameters
    ----------
    lengths, kind
        Distinct lengths of time steps, s, and the index of the step before each row, shape (n,).
    channel
        Shape (n,): output of each row.
    matrix, seen
        Shape (s, s) and (o, s): rates of the states, and outputs, by the states.
    begun, drive
        Shape (s,): variance of each state at the start, and intensity of the white noise that drives its
        rate.
    white, coloured
        Shape (o,): standard deviations of each output's white and coloured noise, SI.
    memory_s
        Correlation time of the coloured noise, s.
    """
    s, o, k = len(drive), len(seen), columns.shape[1]
    n = s + o
    P, X, out, std = np.zeros((n, n)), np.zeros((n, k)), np.empty(columns.shape), np.empty(len(columns))
    moved, gain, turned = np.empty((s, n)), np.empty(n), np.empty((s, k))
    steps, fresh = np.empty((len(lengths), s, s)), np.empty((len(lengths), s, s))
    keep = np.exp(-lengths / memory_s)
    for u in range(len(lengths)):
        steps[u], fresh[u] = _over(lengths[u], matrix, drive)
    for a in range(s):
        P[a, a] = begun[a]
    for c in range(o):
        P[s + c, s + c] = coloured[c] ** 2
    for i in range(len(channel)):
        u = kind[i]
        if lengths[u] > 0.0:
            _propagate(P, moved, steps[u], fresh[u], keep[u], coloured)
            _advance(X, turned, steps[u], keep[u])
        c = channel[i]
        variance = white[c] ** 2 + _seen(P, gain, seen[c], s + c)
        std[i] = np.sqrt(variance)
        for j in range(k):
            innovation = columns[i, j] - X[s + c, j]
            for b in range(s):
                innovation -= seen[c, b] * X[b, j]
            share = innovation / variance
            for a in range(n):
                X[a, j] += gain[a] * share
            out[i, j] = innovation / std[i]
        for a in range(n):
            share = gain[a] / variance
            for b in range(n):
                P[a, b] -= share * gain[b]
    return out, std
