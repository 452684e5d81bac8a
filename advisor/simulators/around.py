"""Effects around a simulator: on the command before it, and in the instruments after it."""

import numpy as np

from advisor.gap.simulator.layout import EFFECT_ENTRIES, INDEX, SKEWS
from advisor.oem.lag import lagged
from advisor.process.arrays import FloatArray

COMMAND = EFFECT_ENTRIES[: EFFECT_ENTRIES.index("M_delta2")]
"""Entries for effects between command and surface."""


def instruments(
    grid: FloatArray, speed: FloatArray, surface: FloatArray, h: float, p: FloatArray
) -> FloatArray:
    """Return the motion as its instruments read it, without the skew of their stamps.

    Parameters
    ----------
    grid
        Shape (4, n + 1): α, q, a_z, θ every ``h`` seconds.
    speed
        Shape (n + 1,): air speed, m/s.
    surface
        Shape (n,): mean deflection over each step, rad from trim, which excites a structural mode.
    h
        Time step, s.
    p
        Shape (entries,): simulator inputs in the order of ``advisor.gap.simulator.layout.ENTRIES``.

    Returns
    -------
    Shape (4, n + 1).
    """
    alpha, q, a_z, theta = grid
    trim = alpha[0]
    vane = lagging(alpha - p[INDEX["vane_arm_m"]] * q / speed, h, float(p[INDEX["alpha_lag_s"]]))
    bend, rate = second_order_response(
        surface, h, float(p[INDEX["mode_rad_s"]]), float(p[INDEX["mode_damping"]])
    )
    softness = 1.0 / p[INDEX["mode_rad_s"]] if p[INDEX["mode_rad_s"]] > 0.0 else 0.0
    of_rate = p[INDEX["mode_rate_gain"]] * softness
    gyro = (
        (1.0 + p[INDEX["q_scale"]]) * q + p[INDEX["q_bias"]] + p[INDEX["mode_gain"]] * bend + of_rate * rate
    )
    return np.stack(
        [
            trim + (1.0 + p[INDEX["alpha_scale"]]) * (vane - trim),
            gyro,
            a_z - p[INDEX["imu_arm_m"]] * np.gradient(q, h),
            theta + p[INDEX["mode_attitude"]] * of_rate * bend,
        ]
    )


def skewed(grid: FloatArray, h: float, p: FloatArray) -> FloatArray:
    """Return the series, shape (4, n + 1), delayed by the skews in ``p``."""
    t = np.arange(grid.shape[1]) * h
    return np.stack([np.interp(t - p[INDEX[name]], t, y) for name, y in zip(SKEWS, grid, strict=True)])


def lagging(y: FloatArray, h: float, lag_s: float) -> FloatArray:
    """Return a series of shape (n,) after a first-order lag, linear between samples; a negative lag leads."""
    if lag_s <= 0.0:
        return y - lag_s * np.gradient(y, h) if lag_s < 0.0 else y
    return lagged(np.full(len(y) - 1, h), y[:-1], y[1:], lag_s, float(y[0]))


def second_order_response(
    surface: FloatArray, h: float, omega_rad_s: float, damping: float
) -> tuple[FloatArray, FloatArray]:
    """Return the angle of a structural mode excited by the surface, rad, and its rate, each (n + 1,)."""
    n = len(surface)
    bend, rate = np.zeros(n + 1), np.zeros(n + 1)
    if omega_rad_s <= 0.0:
        return bend, rate
    damped = np.sqrt(max(1.0 - damping**2, 1e-6))
    fade = np.exp(-damping * omega_rad_s * h)
    swing = np.cos(omega_rad_s * damped * h)
    turn = np.sin(omega_rad_s * damped * h) / damped
    for i in range(n):
        off, at = bend[i] - surface[i], rate[i]
        bend[i + 1] = surface[i] + fade * ((swing + damping * turn) * off + turn * at / omega_rad_s)
        rate[i + 1] = fade * ((swing - damping * turn) * at - omega_rad_s * turn * off)
    return bend, rate
