"""Compiled Kalman filter of a linear motion that white noise drives, measured with coloured noise.

The states of the motion come first, then one state for the coloured noise of each output. Rows are in order
of time, so that every update is scalar.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from advisor.process.arrays import FloatArray, IntArray
from advisor.process.compiled import kernel

_GRID_S = 1e-4
"""Numerical: grid of the time steps, s, so that equal steps share their matrices. Residuals hardly change
within half of this time.
"""
_LONGEST = 0.25
"""Numerical: largest product of a rate of the motion and a time step for a series of third order."""
_ABREAST = 8
"""Numerical: number of noises that fills the processor's vectors."""
_ALONE = (0,)
"""Says that a single noise passes."""


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


class Gains(NamedTuple):
    """Kalman gains of n rows in order of time, for s states and o outputs."""

    steps: FloatArray
    """Shape (u, s, s): transition of the states over each distinct time step."""
    keep: FloatArray
    """Shape (u,): factor by which the coloured noise decays within each distinct time step."""
    kind: IntArray
    """Shape (n,): index of the time step before each row."""
    channel: IntArray
    """Shape (n,): output of each row."""
    seen: FloatArray
    """Shape (o, s): outputs by the states."""
    gain: FloatArray
    """Shape (n, s + o): Kalman gain of each row."""
    std: FloatArray
    """Shape (n,): standard deviation of each row's innovation."""

    def innovations(self, columns: FloatArray, order: IntArray | None = None) -> FloatArray:
        """Return the innovations (n, k) of ``columns`` (n, k) over their standard deviations, row by row.

        ``order`` gives the rows in order of time; None for rows that are in this order.
        """
        rows = np.arange(len(columns)) if order is None else order
        if columns.shape[1] == 1:
            return np.asarray(_passed_alone(self, columns[:, 0], rows))[:, None]
        return np.asarray(_passed(self, columns, rows))


def steps_of(t: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the distinct lengths (u,) of the steps between times, and the index (n,) of the step before each
    time."""
    lengths, kind = np.unique(np.rint(np.diff(t, prepend=t[0]) / _GRID_S), return_inverse=True)
    return lengths * _GRID_S, kind.astype(np.int64)


def driven_filter(
    steps: tuple[FloatArray, IntArray], channel: IntArray, seen: FloatArray,
    driving: tuple[FloatArray, FloatArray, FloatArray], white: FloatArray, coloured: FloatArray,
    memory_s: float,
) -> Gains:  # fmt: skip
    """Return the Kalman gains of rows in order of time.

    Parameters
    ----------
    steps
        Distinct lengths of time steps, s, and the index of the step before each row, as ``steps_of`` returns
        them.
    channel
        Shape (n,): output of each row.
    seen
        Shape (o, s): outputs by the states.
    driving
        Rates of the states by the states (s, s), variance of each state at the start (s,), and intensity of
        the white noise that drives each rate (s,).
    white
        Shape (n,): variance of each row's white noise, SI.
    coloured
        Shape (o,): standard deviation of each output's coloured noise, SI.
    memory_s
        Correlation time of the coloured noise, s.
    """
    lengths, kind = steps
    keep = np.exp(-lengths / memory_s)
    matrix, begun, drive, *measured = (part[..., None] for part in (*driving, white, coloured**2))
    at, nothing = (_ALONE, lengths, keep[:, None], kind, channel, seen), np.zeros(len(channel))
    moves, gain, std, _ = _filtered(*at, matrix, begun, drive, measured[0], measured[1], nothing)
    return Gains(moves[..., 0], keep, kind, channel, seen, gain, std[:, 0])


def filtered_by_each(
    steps: tuple[FloatArray, IntArray], channel: IntArray, seen: FloatArray,
    driving: Sequence[tuple[FloatArray, FloatArray, FloatArray]], white: FloatArray, coloured: FloatArray,
    memory_s: FloatArray, column: FloatArray,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return a column's innovations (n, k) with each of k noises over their standard deviations, and these.

    The arguments are those of ``driven_filter`` for each noise; ``white`` is by output, shape (k, o). Noises
    that pass abreast take a third of the time that they take one after another.
    """
    k, (lengths, kind) = len(driving), steps
    lanes = np.resize(np.arange(k), 1 if k == 1 else -(-k // _ABREAST) * _ABREAST)
    driven = (np.stack([each[part] for each in driving], axis=-1)[..., lanes] for part in range(3))
    numbers = *driven, white.T[channel][:, lanes], coloured.T[:, lanes] ** 2
    matrix, begun, drive, by_row, own = map(np.ascontiguousarray, numbers)
    keep, alone = np.exp(-lengths[:, None] / memory_s[lanes]), _ALONE if k == 1 else ()
    at = alone, lengths, keep, kind, channel, seen, matrix
    *_, std, out = _filtered(*at, begun, drive, by_row, own, column)
    return out[:, :k], std[:, :k]


@kernel(error_model="numpy", fastmath={"contract"})
def _passed(gains: Gains, columns: FloatArray, order: IntArray) -> FloatArray:
    """Return the innovations (n, k) of ``columns`` (n, k)."""
    seen, gain = gains.seen, gains.gain
    s, n, k = seen.shape[1], gain.shape[1], columns.shape[1]
    X, out, turned, innovation = np.zeros((n, k)), np.empty(columns.shape), np.empty((s, k)), np.empty(k)
    for i in range(len(gain)):
        u, row, c = gains.kind[i], order[i], gains.channel[i]
        if gains.keep[u] < 1.0:
            turned[:] = 0.0
            for a in range(s):
                for b in range(s):
                    for j in range(k):
                        turned[a, j] += gains.steps[u, a, b] * X[b, j]
            X[:s] = turned
            X[s:] *= gains.keep[u]
        for j in range(k):
            innovation[j] = columns[row, j] - X[s + c, j]
        for b in range(s):
            if seen[c, b] != 0.0:
                for j in range(k):
                    innovation[j] -= seen[c, b] * X[b, j]
        for a in range(n):
            for j in range(k):
                X[a, j] += gain[i, a] * innovation[j]
        for j in range(k):
            out[row, j] = innovation[j] / gains.std[i]
    return out


@kernel(error_model="numpy", fastmath={"contract"})
def _passed_alone(gains: Gains, column: FloatArray, order: IntArray) -> FloatArray:
    """Return the innovations (n,) of one column (n,), three times as fast as ``_passed`` does."""
    s, n = gains.seen.shape[1], gains.gain.shape[1]
    x, turned, out = np.zeros(n), np.zeros(n), np.empty(len(column))
    for i in range(len(column)):
        u, row, c = gains.kind[i], order[i], gains.channel[i]
        if gains.keep[u] < 1.0:
            for a in range(n):
                turned[a] = gains.keep[u] * x[a] if a >= s else 0.0
                for b in range(s if a < s else 0):
                    turned[a] += gains.steps[u, a, b] * x[b]
            x, turned = turned, x
        left = column[row] - x[s + c]
        for b in range(s):
            left -= gains.seen[c, b] * x[b]
        for a in range(n):
            x[a] += gains.gain[i, a] * left
        out[row] = left / gains.std[i]
    return out


@kernel(error_model="numpy", fastmath={"contract"})
def _advanced(
    alone: tuple[int, ...], P: FloatArray, moved: FloatArray, step: FloatArray, fresh: FloatArray,
    keep: FloatArray, own: FloatArray,
) -> None:  # fmt: skip
    """Advance ``P`` of ``_filtered`` by a step; ``moved``, shape (s, n + 1, k), is work space."""
    k, s, n = 1 if len(alone) else len(keep), len(step), len(P)
    _turned(alone, moved, step, P)
    for a in range(s):
        for b in range(n + 1):
            for j in range(k):
                P[a, b, j] = fresh[a, b, j] if b < s else moved[a, b, j]
        for b in range(s):
            for c in range(s):
                for j in range(k):
                    P[a, b, j] += moved[a, c, j] * step[b, c, j]
    for b in range(s, n):
        for a in range(n):
            for j in range(k):
                P[a, b, j] *= keep[j] if a < s else keep[j] * keep[j]
        for j in range(k):
            P[b, b, j] += own[b - s, j] * (1.0 - keep[j] * keep[j])
            P[b, n, j] *= keep[j]


@kernel(error_model="numpy", fastmath={"contract"})
def _turned(alone: tuple[int, ...], to: FloatArray, step: FloatArray, of: FloatArray) -> None:
    """Write the product (s, n + 1, k) of transitions (s, s, k) and the first rows of ``of``."""
    k = 1 if len(alone) else to.shape[2]
    for a in range(len(to)):
        for b in range(to.shape[1]):
            for j in range(k):
                to[a, b, j] = 0.0
        for c in range(len(to)):
            for b in range(to.shape[1]):
                for j in range(k):
                    to[a, b, j] += step[a, c, j] * of[c, b, j]


@kernel(error_model="numpy", fastmath={"contract"})
def _showing(
    alone: tuple[int, ...], P: FloatArray, seen: FloatArray, own: int, measured: float, gain: FloatArray
) -> None:
    """Write the covariance of an output with all in ``P`` of ``_filtered``, then minus the innovation."""
    k, n = 1 if len(alone) else P.shape[2], len(P)
    for a in range(n):
        for j in range(k):
            gain[a, j] = P[a, own, j]
    for j in range(k):
        gain[n, j] = P[own, n, j] - measured
    for b in range(len(seen)):
        for a in range(n + 1 if seen[b] != 0.0 else 0):
            for j in range(k):
                gain[a, j] += seen[b] * P[b, a, j]


@kernel(error_model="numpy", fastmath={"contract"})
def _filtered(
    alone: tuple[int, ...], lengths: FloatArray, keep: FloatArray, kind: IntArray, channel: IntArray,
    seen: FloatArray, matrix: FloatArray, begun: FloatArray, drive: FloatArray, white: FloatArray,
    own: FloatArray, column: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """Return transitions (u, s, s, k), gains (n, s + o), standard deviations (n, k), and innovations (n, k).

    The gains are those with the first noise. The innovations are those of a column (n,), over their standard
    deviations.
    The last index of an argument that depends on the noise is that of the noise. ``alone`` is not empty where
    the noise is one, which the compiler then knows. ``own`` holds the variances of the coloured noise. ``P``
    is the covariance, without the part that follows from symmetry; its last column holds the states.
    """
    k, s, rows = 1 if len(alone) else drive.shape[1], len(drive), len(channel)
    n = s + len(seen)
    P, moved, gain = np.zeros((n, n + 1, k)), np.empty((s, n + 1, k)), np.empty((n + 1, k))
    steps, fresh = np.empty((len(lengths), s, s, k)), np.empty((len(lengths), s, s, k))
    gains, std, out, share = np.empty((rows, n)), np.empty((rows, k)), np.empty((rows, k)), np.empty(k)
    for j in range(k):
        for u in range(len(lengths)):
            over = _over(lengths[u], np.ascontiguousarray(matrix[:, :, j]), drive[:, j])
            steps[u, :, :, j], fresh[u, :, :, j] = over
        for a in range(n):
            P[a, a, j] = begun[a, j] if a < s else own[a - s, j]
    for i in range(rows):
        u, c = kind[i], channel[i]
        if lengths[u] > 0.0:
            _advanced(alone, P, moved, steps[u], fresh[u], keep[u], own)
        _showing(alone, P, seen[c], s + c, column[i], gain)
        for j in range(k):
            variance = white[i, j] + gain[s + c, j]
            for b in range(s):
                variance += seen[c, b] * gain[b, j]
            std[i, j] = np.sqrt(variance)
            out[i, j] = -gain[n, j] / std[i, j]
        for a in range(n):
            for j in range(k):
                share[j] = gain[a, j] / std[i, j] ** 2
            gains[i, a] = share[0]
            for b in range(0 if a < s else s, n + 1):
                for j in range(k):
                    P[a, b, j] -= share[j] * gain[b, j]
    return steps, gains, std, out
