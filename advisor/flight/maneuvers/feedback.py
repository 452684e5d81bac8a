"""Share of an elevator movement that feedback of the motion explains.

A pilot who brings the aircraft back to steady flight responds to its earlier motion. Such a movement obeys

    δe(t) = δ0 + s·[Kq·q(t − τ) + Kθ·θ(t − τ)],   Kq ≥ 0, Kθ ≥ 0,

with s the sign of the stabilising side, and with a delay τ of the hand. A feedback movement begins with a
disturbed attitude and ends with the attitude restored. A test input begins in steady flight and moves the
aircraft away from it. An unstable aircraft always needs feedback, so the share alone refuses no movement. The
coefficients are a non-negative least-squares fit (Lawson & Hanson, Solving Least Squares Problems, 1974, ch.
23). The fit begins at the onset of the movement.
"""

from collections.abc import Mapping

import numpy as np

from advisor.flight.maneuvers.loop import PITCH, Loop
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

DELAYS_S = (0.1, 0.2, 0.3)
"""Delays between the motion and the hand's response, s. Pilots have 0.1 to 0.3 (McRuer & Krendel 1974)."""
HISTORY_S = 15.0
"""Length of flight before a movement whose median pitch angle is the pilot's target, s. This length contains
one test input with its free response, and some steady flight."""
_FEWEST = 8
"""Least number of elevator samples for the feedback law with four unknowns."""
_AT_S = 0.2
"""Length over which the pitch angle at onset and end is averaged, s: one delay of a hand."""


def explained_by_feedback(
    span: Span, elevator: Channel, motion: Mapping[str, Channel], effect: float, loop: Loop = PITCH
) -> float:
    """Return the share of a movement's variation that feedback of the motion explains, 0 to 1.

    Parameters
    ----------
    elevator
        Elevator channel, rad.
    motion
        Channels ``q`` and ``theta`` from ``HISTORY_S`` before the movement to its end. If a channel is
        missing, the share is 0.
    effect
        Elevator's effect on the pitch rate. Only the sign is used; 0 means unknown.
    loop
        Another control, whose rate and angle replace q and θ.

    Returns
    -------
    float
        The share is 0 if the movement does not bring the pitch angle back to its earlier median.
    """
    moved = elevator.cut(span.start_s, span.end_s)
    if not {loop.rate, loop.angle} <= motion.keys() or effect == 0.0 or len(moved) < _FEWEST:
        return 0.0
    u = -np.sign(effect) * moved.y
    varying = float(np.sum((u - np.mean(u)) ** 2))
    if varying == 0.0 or not _comes_back(motion[loop.angle], span):
        return 0.0
    left = min(_left(motion[loop.rate], motion[loop.angle], moved.t - delay_s, u) for delay_s in DELAYS_S)
    return max(0.0, 1.0 - left / varying)


def _comes_back(theta: Channel, span: Span) -> bool:
    """Return whether the pitch angle is nearer to its earlier median at the end than at the onset."""
    kept = theta.cut(-np.inf, span.start_s).y
    first, last = (theta.cut(at_s - _AT_S, at_s).y for at_s in (span.start_s, span.end_s))
    if not (len(kept) and len(first) and len(last)):
        return False
    off = [abs(float(np.mean(angles) - np.median(kept))) for angles in (first, last)]
    return off[1] < off[0]


def _left(q: Channel, theta: Channel, t: FloatArray, u: FloatArray) -> float:
    """Return the residual sum of squares of a movement after the fit of the feedback law."""
    rate, pitch = np.interp(t, q.t, q.y), np.interp(t, theta.t, theta.y)
    level = np.ones(len(t))
    terms = np.column_stack([rate, pitch - np.mean(pitch), level, -level])
    size = np.maximum(np.abs(terms).max(axis=0), 1e-12)
    from scipy.optimize import nnls  # not on the start path

    return float(nnls(terms / size, u)[1]) ** 2
