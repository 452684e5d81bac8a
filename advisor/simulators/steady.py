"""Steady flight of a simulator that can only step, and its state between two steps."""

from collections.abc import Callable, Sequence

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import State

_DIFFERENCE = 1e-3
"""Finite-difference step of an unknown of the trim, rad or share of the throttle."""
_ROUNDS = 40
_STEADY = 1e-4
"""Rates of α (rad/s), q (rad/s²) and relative speed (1/s) below which flight counts as steady."""
_LONGEST_MOVE = 0.1
"""Longest Newton step of an angle, rad, or of the throttle."""


def steady(rates: Callable[[FloatArray], FloatArray], start: FloatArray) -> FloatArray | None:
    """Return the unknowns for which all rates are zero (Newton's method); None if none are found.

    Parameters
    ----------
    rates
        Function that returns the rates for the unknowns, both of shape (n,).
    """
    at = start
    for _ in range(_ROUNDS):
        now = rates(at)
        if np.max(np.abs(now)) < _STEADY:
            return at
        steps = _DIFFERENCE * np.eye(len(at))
        slopes = np.column_stack([(rates(at + h) - rates(at - h)) / (2.0 * _DIFFERENCE) for h in steps])
        if not np.all(np.isfinite(slopes)) or np.linalg.matrix_rank(slopes) < len(at):
            return None
        move = np.linalg.solve(slopes, -now)
        at = at + move * min(1.0, _LONGEST_MOVE / float(np.max(np.abs(move))))
    return None


def midway(
    rows: Sequence[Sequence[float]], t: float, step_s: float, elevator: float, throttle: float
) -> State:
    """Return the state in the middle of the next step, extrapolated by the last step's rates.

    Parameters
    ----------
    rows
        Motion after each step: α, q, θ, a_z, air speed and height, then other quantities.
    """
    before, now = rows[-2] if len(rows) > 1 else rows[-1], rows[-1]
    alpha_dot, q_dot = ((now[i] - before[i]) / step_s for i in (0, 1))
    half = 0.5 * step_s
    return State(
        float(t), now[0] + half * alpha_dot, alpha_dot, now[1] + half * q_dot, float(elevator),
        now[4], now[5], float(throttle),
    )  # fmt: skip
