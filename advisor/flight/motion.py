"""What holds for any aircraft, whatever its aerodynamics: how speed follows from specific force."""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gravity import GRAVITY_M_S2


def speed_rate(a_x: FloatArray, a_z: FloatArray, theta: FloatArray, alpha: FloatArray) -> FloatArray:
    """Rate of the speed, m/s², that the accelerometers know of: in air that moves steadily.

    V̇ = a_x cos α + a_z sin α − g sin(θ − α); specific force in m/s², angles in rad, all of shape (n,).
    """
    return a_x * np.cos(alpha) + a_z * np.sin(alpha) - GRAVITY_M_S2 * np.sin(theta - alpha)


def integrated(t: FloatArray, rate: FloatArray) -> FloatArray:
    """Running integral by trapezoids over stamps ``t`` in s, shape (n,), 0 at the first."""
    total: FloatArray = np.concatenate(([0.0], np.cumsum(np.diff(t) * (rate[1:] + rate[:-1]) / 2.0)))
    return total
