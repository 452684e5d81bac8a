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

from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem import kalman
from advisor.oem.kalman import DIFFUSE

ALPHA, A_Z = OUTPUTS.index("alpha"), OUTPUTS.index("a_z")


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

    @classmethod
    def still(cls, white: FloatArray, seen_by_alpha: float = 1.0) -> "AirModel":
        """Return white noise of the instruments, shape (4,), and nothing besides."""
        return cls(white, np.full(len(OUTPUTS), 1e-12), 0.3, 0.0, 1.0, seen_by_alpha)


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
        """Return whitened columns, shape (n, k), in the same order of rows: ``order`` says which come in
        time."""
        rows = np.arange(len(columns)) if order is None else order
        return np.asarray(
            kalman.pass_through(
                self.step, self.keep, self.gain, self.root, self.channel, self.observed, columns, rows
            )
        )


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
    observed = kalman.observed_by(system, air.seen_by_alpha, *arms_m)
    step, keep, gain, root = kalman.gains_along(
        t, channel, system, white, _memory(air), observed, start_variance
    )
    return Gains(step, keep, gain, root, channel, observed)


def cost_of(
    t: FloatArray,
    channel: np.ndarray,
    residual: FloatArray,
    system: FloatArray,
    air: AirModel,
    start_variance: float = DIFFUSE,
) -> float:
    """-2 log likelihood of a residual, shape (n,), without its constant and without rows still diffuse.

    Arguments as in ``gains_of``. A search for the noise asks for it a few hundred times, so nothing is kept.
    """
    observed = kalman.observed_by(system, air.seen_by_alpha, 0.0, 0.0)
    return float(
        kalman.cost_along(t, channel, residual, system, air.white**2, _memory(air), observed, start_variance)
    )


def _memory(air: AirModel) -> FloatArray:
    """Return coloured noise by channel and its memory, the gust and its memory, shape (7,)."""
    return np.array([*air.coloured, air.memory_s, air.gust, air.gust_memory_s])
