"""The prior of Z_q and Z_δe for an aircraft with a tail, where no angle of attack is measured.

Without a vane, Z_q and Z_δe are correlated with Z_α in pitch rate and specific force of a well damped
aircraft. Both are small on every aircraft:

- Z_q = -ρ·S·c·C_Lq/(4·m) is the lift of the pitch rate relative to the turn of the path;
- Z_δe/M_δe = k_y²/(l_t·V): the tail's lift turns the path by its force, the nose by its moment, with k_y the
  radius of gyration and l_t the tail's lever.
"""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import N_SHARED, SHARED
from advisor.oem.problem import OutputErrorProblem

Z_Q_STD = 0.1
"""Standard deviation of Z_q, 1. C_Lq of 10 gives 0.03 to 0.1 for aircraft of 3 kg to 8 t."""
LIFT_OVER_MOMENT_S = 0.02
"""Standard deviation of Z_δe/M_δe, s. Published estimates give 0.008 (twin jet) and 0.010 (twin
turboprop)."""


def precision(problem: OutputErrorProblem, shared: FloatArray) -> FloatArray:
    """Return the inverse prior variances of the shared parameters about zero.

    Parameters
    ----------
    shared
        Shape (7,), in the order of ``SHARED``; M_δe scales the prior of Z_δe.

    Returns
    -------
    FloatArray
        Shape (7,). Zero throughout where every record has an angle of attack.
    """
    if all("alpha" in record.outputs for record in problem.records):
        return np.zeros(N_SHARED)
    return precision_without_alpha(shared)


def precision_without_alpha(shared: FloatArray) -> FloatArray:
    """Return inverse prior variances without a measured angle of attack, shape (7,), for ``shared`` (7,)
    parameters."""
    weight = np.zeros(N_SHARED)
    moment = max(abs(float(shared[SHARED.index("M_delta_e")])), 1e-6)
    weight[SHARED.index("Z_q")] = Z_Q_STD**-2
    weight[SHARED.index("Z_delta_e")] = (LIFT_OVER_MOMENT_S * moment) ** -2
    return weight
