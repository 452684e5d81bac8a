"""Eqs. (1)-(2) at one state, for simulators that add the terms of effects to their own."""

import numpy as np

from advisor.gap.simulator import pack as row
from advisor.gap.simulator.layout import AT, LAYOUT, OTHER_LAYOUT, SLOW
from advisor.gap.simulator.pack import ROWS
from advisor.gap.simulator.step import hold_over_step, moment, near_ground, normal_force, stall, take_speed
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

MOTION = SPEED, HEIGHT, ALPHA, ALPHA_DOT, Q, DEFLECTION, ALPHA_TRIM = range(7)
"""Indices in a motion: air speed (m/s), height (m), α and its rate, q, elevator from trim, α at trim."""


@kernel(error_model="numpy", fastmath={"contract"})
def right_sides(
    layout: int, p: FloatArray, motion: FloatArray, reference: float, lift: FloatArray, engine: FloatArray
) -> FloatArray:
    """Return normal force over m·V (rad/s) and pitch acceleration (rad/s²) in one state.

    Parameters
    ----------
    layout
        ``layout.LAYOUT``.
    p
        Shape (k, entries): simulator inputs.
    motion
        Shape (7,), in the order of ``MOTION``.
    reference
        Reference speed of the derivatives, m/s.
    lift, engine
        Shape (k,): lagging angle of attack (rad) and lagging throttle, relative to its start, of each
        parameter set.

    Returns
    -------
    Shape (k, 2).

    Raises
    ------
    ValueError
        The function was compiled for another layout.
    """
    if layout != LAYOUT or p.shape[1] != len(AT):
        raise ValueError(OTHER_LAYOUT)
    lanes = len(p)
    x, none, slow = np.zeros((ROWS, lanes)), np.zeros(lanes), np.zeros(len(SLOW))
    delta = np.full(lanes, motion[DEFLECTION])
    for m in range(lanes):
        x[: len(AT), m] = p[m]
        x[row.ALPHA, m], x[row.Q, m] = motion[ALPHA], motion[Q]
        x[row.FOLLOWED, m], x[row.LIFT, m], x[row.ATTACHED, m] = motion[ALPHA], lift[m], 1.0
        x[row.ENGINE, m], x[row.ENGINE_DECAY, m] = engine[m], 1.0
    take_speed(x, lanes, motion[SPEED], 0.0, reference, True, True)
    near_ground(x, lanes, motion[HEIGHT])
    hold_over_step(x, lanes, delta, none, slow, 1.0, (0.0, 0.0, 0.0))
    stall(x, lanes, 0.0, 0.0)
    out = np.empty((lanes, 2))
    for m in range(lanes):
        da, behind = motion[ALPHA] - motion[ALPHA_TRIM], motion[ALPHA] - lift[m]
        out[m, 0] = normal_force(x, m, motion[ALPHA], motion[Q], da, behind)
        out[m, 1] = moment(x, m, motion[Q], motion[ALPHA_DOT], da, behind)
    return out
