"""Linear short-period motion with the gust's angle, for the filter of driven motions.

    δα̇ = Z_α (δα + η) + (1 + Z_q) δq,   δq̇ = M_α (δα + η) + M_q δq,   δθ̇ = δq

η is the gust angle w/V.
"""

import numpy as np

from advisor.oem.driven_motion.setting import Linear
from advisor.process.arrays import FloatArray


def short_period_motion(
    system: FloatArray,
    airspeed_m_s: float,
    arms_m: tuple[float, float] = (0.0, 0.0),
    *,
    seen_by_alpha: bool = True,
    scale: float = 1.0,
) -> Linear:
    """Return the motion of α, q and θ, seen by α, q, a_z and θ.

    Parameters
    ----------
    system
        Derivatives Z_α, Z_q, M_α and M_q at the air speed.
    arms_m
        Distances of the vane and of the accelerometer ahead of the centre of gravity, m.
    seen_by_alpha
        Whether a vane measures α; an α from inertial sensors does not see gusts.
    scale
        Air speed of the specific force over the measured one.
    """
    force, moment = np.array([[*system[:2], 0.0], [*system[2:], 0.0]])
    vane_m, imu_m = arms_m
    matrix = np.array([force + np.array([0.0, 1.0, 0.0]), moment, [0.0, 1.0, 0.0]])
    lift = scale * airspeed_m_s * force - imu_m * moment
    seen = np.array([[1.0, -vane_m / airspeed_m_s, 0.0], [0.0, 1.0, 0.0], lift, [0.0, 0.0, 1.0]])
    air_seen = np.array([float(seen_by_alpha), 0.0, lift[0], 0.0])
    return Linear(matrix, seen, np.array([force[0], moment[0], 0.0]), air_seen, np.array([0, 1]))
