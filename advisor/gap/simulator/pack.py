"""A pack of simulations: an array of shape (``ROWS``, ``LANES``), the meaning of its rows, and initial
values.

The first rows are the simulator inputs of ``advisor.gap.simulator.layout``. Each column of an array, called a
lane, is one simulation.
"""

import numpy as np

from advisor.gap.simulator.layout import AT, TRIM
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

LANES = 8
"""Number of simulations in a pack: as many as the widest registers hold doubles."""
_ANYWHERE = 9.0
"""Stop angle of a vane without stops, rad: larger than any angle of attack."""
# Rows behind the driving numbers: constants of the run, the state, and values handed on within a step.
(
    DOSE, ENGINE_DECAY, LIFT_DECAY, VANE_DECAY, VANE_RAMP, FADE, SWING_COS, SWING_SIN, SOFTNESS,
    ALPHA, Q, THETA, ENGINE, LIFT, FOLLOWED, VANE_BEFORE, VANE_OUT, SHOWN,
    HIGHEST, LOWEST, SEPARATED, MISSING, BEND, BEND_RATE,
    AIRSPEED, RATIO, NEAR, POWER, TURNING, ATTACHED, COS_ALPHA, SIN_ALPHA, GRAVITY, LIFTING, MOMENT_SLOPE,
    DEFLECTION, AIR, Z_REST, M_REST, KA, KQ, NORMAL_0, QDOT_0, ROWS,
) = range(len(AT), len(AT) + 44)  # fmt: skip


@kernel(error_model="numpy")
def begin(
    x: FloatArray, lane: int, p: FloatArray, dose: float, h: float, speed: float, trim: FloatArray
) -> None:
    """Fill one lane of a pack with its simulator inputs, the constants of the run, and the initial state."""
    x[: len(p), lane] = p
    x[DOSE, lane] = dose
    x[ENGINE_DECAY, lane] = np.exp(-h / max(p[AT.engine_lag_s], 1e-3 * h))
    x[LIFT_DECAY, lane] = np.exp(-h / max(p[AT.lift_lag_s], 0.2 * h))
    # First order in the lag, so that the sensitivity to a lag exists at a lag of zero.
    tau = p[AT.alpha_lag_s]
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    x[VANE_DECAY, lane], x[VANE_RAMP, lane] = decay, (tau / h) * (1.0 - decay)
    # The mode is solved exactly, because it is fast relative to the step. ``SWING_SIN`` is sin(ω_d h) ω/ω_d.
    omega, zeta = p[AT.mode_rad_s], p[AT.mode_damping]
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    x[FADE, lane] = np.exp(-zeta * omega * h)
    x[SWING_COS, lane] = np.cos(omega * damped * h)
    x[SWING_SIN, lane] = np.sin(omega * damped * h) / damped
    x[SOFTNESS, lane] = 1.0 / omega if omega > 0.0 else 0.0
    x[ALPHA, lane], x[Q, lane] = trim[TRIM.alpha] + p[AT.alpha_start], p[AT.q_start]
    x[THETA, lane] = trim[TRIM.theta]
    x[ENGINE, lane], x[LIFT, lane], x[FOLLOWED, lane] = 0.0, trim[TRIM.alpha], x[ALPHA, lane]
    x[VANE_OUT, lane] = x[ALPHA, lane] - p[AT.vane_arm_m] * x[Q, lane] / speed
    x[VANE_BEFORE, lane] = x[VANE_OUT, lane]
    x[SHOWN, lane] = x[VANE_OUT, lane]
    x[SEPARATED, lane], x[MISSING, lane] = 0.0, 0.0
    up, down = p[AT.vane_stop_up_rad], p[AT.vane_stop_down_rad]
    x[HIGHEST, lane] = up if up > 0.0 else _ANYWHERE
    x[LOWEST, lane] = -down if down > 0.0 else -_ANYWHERE
    x[BEND, lane], x[BEND_RATE, lane] = 0.0, 0.0
    x[NEAR, lane], x[POWER, lane], x[TURNING, lane], x[ATTACHED, lane] = 0.0, 1.0, 1.0, 1.0
