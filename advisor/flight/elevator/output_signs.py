"""Signs of several elevator outputs in pitch, from the aircraft's response to all outputs."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from advisor.flight.signals.motion import integrated
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

_SURELY = 9.0
"""Least value of twice the log likelihood ratio of both signs at which an output's sign is known. The number
of independent samples follows from the correlation of successive residuals. For eight aircraft with two
outputs that also roll, manoeuvres reach values of 10 to
120. A wrong sign never exceeded a value of 8."""
_LEAST_S = 4.0
"""Shortest flight from which the outputs' signs are determined, s. In records of one to three seconds slow
movements look alike, and a wrong sign reached a value of 22.
"""
_EXPLAINED = 0.7
"""Least share of the pitch rate's power that the regression must explain, as in ``elevator_sign.py``."""
_MOST = 8
"""Largest number of outputs whose signs are tried together, in 256 combinations."""


def pitch_signs(
    t: FloatArray,
    angles: FloatArray,
    shares: Sequence[float],
    q: Channel,
    alpha: Channel | None,
    singly: bool = False,
) -> list[bool | None]:
    """Return whether a positive deflection of each output raises the nose; None for a resting or uncertain
    output.

    The signs come from least squares of the pitch rate on the integrals of elevator, pitch rate and α. The
    elevator is the sum of all outputs, each with either sign. With the right signs the roll parts of elevons
    cancel and the pitch parts add up.

    Parameters
    ----------
    t
        Shape (n,): stamps of the outputs, s.
    angles
        Shape (n, k): deflection of each output, rad.
    shares
        Shares of the k outputs in the elevator's deflection.
    q, alpha
        Pitch rate, and angle of attack if any, over the time of the outputs.
    singly
        Whether an output with an uncertain sign is also regressed alone. Outputs that move in proportion
        explain the pitch rate with either sign, unless each is regressed alone.
    """
    n, k = len(q), angles.shape[1]
    unknown: list[bool | None] = [None] * k
    moves = np.ptp(angles, axis=0) > 0.0
    if n < 20 or k > _MOST or t[-1] - t[0] < _LEAST_S or not moves.any():
        return unknown
    outputs = np.column_stack([_integral(q.t, t, share * angles[:, i]) for i, share in enumerate(shares)])
    motion = [_integral(q.t, c.t, c.y) for c in (q, alpha) if c is not None]
    others, _ = np.linalg.qr(np.column_stack([*motion, q.t - q.t[0], np.ones(n)]))
    # The parts of the outputs and of the pitch rate that the aircraft's own motion and drifts leave.
    free = outputs - others @ (others.T @ outputs)
    left = q.y - others @ (others.T @ q.y)
    signs = np.array(list(product((1.0, -1.0), repeat=k)))
    remaining, residual = _fitted(signs, free, left)
    if not remaining.min() < (1.0 - _EXPLAINED) * n * np.var(q.y):
        return unknown
    up, down = (np.array([remaining[signs[:, i] == sign].min() for i in range(k)]) for sign in (1.0, -1.0))
    evidence = _independent(residual) * np.log(down / up)
    for i in np.flatnonzero(moves & (np.abs(evidence) <= _SURELY)) if singly else ():
        (rises, falls), residual = _fitted(np.array([[1.0], [-1.0]]), free[:, [i]], left)
        evidence[i] = _independent(residual) * np.log(falls / rises)
    if not np.all(np.abs(evidence[moves]) > _SURELY):
        return unknown
    return [bool(e > 0.0) if m else None for e, m in zip(evidence.tolist(), moves.tolist(), strict=True)]


def _fitted(signs: FloatArray, free: FloatArray, left: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return each combination's residual sum of squares (s,), and the residual of the best."""
    # A combination of signs is used only if its sum has a positive effect.
    power = np.maximum(np.einsum("si,ij,sj->s", signs, free.T @ free, signs), 1e-30)
    effect = np.maximum(signs @ (free.T @ left), 0.0) / power
    total = float(left @ left)
    remaining = np.maximum(total - effect**2 * power, 1e-12 * total)
    best = int(np.argmin(remaining))
    return remaining, left - effect[best] * (free @ signs[best])


def _independent(residual: FloatArray) -> float:
    """Return the number of independent samples with equal information about a mean, from the correlation at
    lag one.
    """
    power = float(residual @ residual)
    correlation = float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0
    correlation = min(max(correlation, 0.0), 1.0)
    return len(residual) * (1.0 - correlation) / (1.0 + correlation)


def _integral(at: FloatArray, t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the integral over ``at``, from its first value, of a signal with samples ``y`` at ``t``."""
    on = np.interp(at, t, y)
    return integrated(at, on - on[0])
