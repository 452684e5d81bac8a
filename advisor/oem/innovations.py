"""Innovations of residuals: a Kalman filter for moving air and coloured instruments.

Near a simulated flight the model is linear:

    δα̇ = Z_α (δα + η) + (1 + Z_q) δq,   δq̇ = M_α (δα + η) + M_q δq,   δθ̇ = δq,   η̇ = −η/T_g + white

where η is the gust angle w/V. Each sensor has first-order noise in addition to its white noise (Jategaonkar,
*Flight Vehicle System Identification*, chapter 5). The gains depend only on times and noise, so they are
computed once. Residuals and sensitivities pass one filter, and least squares of the innovations is then the
best estimate.
"""

from dataclasses import dataclass

import numpy as np

from advisor.model.outputs import OUTPUTS
from advisor.oem.kalman import DIFFUSE, STATES, Gains, filter_along, observed_by
from advisor.process.arrays import FloatArray

ALPHA, A_Z = OUTPUTS.index("alpha"), OUTPUTS.index("a_z")


@dataclass(frozen=True)
class AirModel:
    """Noise of the instruments and motion of the air, as standard deviations in SI units."""

    white: FloatArray
    """Shape (4,): white noise of α, q, a_z, θ."""
    coloured: FloatArray
    """Shape (4,): coloured noise of α, q, a_z, θ."""
    memory_s: float
    """Correlation time of the coloured noise, s."""
    gust: float
    """Standard deviation of the gust angle w/V, rad; 0 for still air."""
    gust_memory_s: float
    seen_by_alpha: float = 1.0
    """1 if a vane measures α, and 0 if α comes from inertial sensors."""

    @classmethod
    def still(cls, white: FloatArray, seen_by_alpha: float = 1.0) -> "AirModel":
        """Return a model of white instrument noise, shape (4,), in still air."""
        return cls(white, np.full(len(OUTPUTS), 1e-12), 0.3, 0.0, 1.0, seen_by_alpha)


def gains_of(
    t: FloatArray,
    channel: np.ndarray,
    system: FloatArray,
    air: AirModel,
    start_variance: float = DIFFUSE,
    extra: FloatArray | float = 0.0,
    arms_m: tuple[float, float] = (0.0, 0.0),
) -> Gains:
    """Return the Kalman gains for rows at ascending times ``t`` of outputs ``channel``, both of shape (n,).

    Parameters
    ----------
    system
        Derivatives Z_α, Z_q, M_α, M_q, and the air speed V.
    start_variance
        Variance of the initial α, q and θ; 0 if the fit estimates the initial states.
    extra
        Shape (n,): additional variance of each row, such as that of an uncertain stamp.
    arms_m
        Distances of the vane and of the accelerometer ahead of the centre of gravity, m.
    """
    white = np.asarray(air.white[channel] ** 2 + extra)
    observed = observed_by(system, air.seen_by_alpha, *arms_m)
    n = len(t)
    gains = Gains(np.empty((n, 4, 4)), np.empty(n), np.empty((n, STATES)), np.empty(n), channel, observed)
    filter_along(t, system, white, _memory(air), start_variance, np.empty(0), gains)
    return gains


def cost_of(
    t: FloatArray,
    channel: np.ndarray,
    residual: FloatArray,
    system: FloatArray,
    air: AirModel,
    start_variance: float = DIFFUSE,
) -> float:
    """Return -2 log likelihood of a residual, shape (n,), up to a constant and without diffuse rows.

    The arguments are those of ``gains_of``. A noise search calls this function a few hundred times, so the
    function stores nothing.
    """
    observed = observed_by(system, air.seen_by_alpha, 0.0, 0.0)
    nothing = np.empty(0)
    gains = Gains(np.empty((0, 4, 4)), nothing, np.empty((0, STATES)), nothing, channel, observed)
    white = air.white[channel] ** 2
    return float(filter_along(t, system, white, _memory(air), start_variance, residual, gains))


def _memory(air: AirModel) -> FloatArray:
    """Return the coloured noise of each channel with its correlation time, then the gust's, shape (7,)."""
    return np.array([*air.coloured, air.memory_s, air.gust, air.gust_memory_s])
