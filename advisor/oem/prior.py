"""Priors of derivatives that a record may not determine.

Without a vane, Z_q and Z_δe are correlated with Z_α in pitch rate and specific force. Priors
of usual size bound Z_q, M_α, M_q and Z_δe:

- Z_q = -ρ·S·c·C_Lq/(4·m) is the lift due to pitch rate, relative to the turn rate of the path;
- M_α and M_q are those of usual coefficients, where the file states wing, chord and inertia;
- Z_δe/M_δe = k_y²/(l_t·V): the tail's lift turns the path by its force and the nose by its moment, with k_y
  the radius of gyration and l_t the tail's lever.
"""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import N_SHARED, SHARED
from advisor.oem.problem import OutputErrorProblem
from advisor.process.arrays import FloatArray

HELD = 1e-6
"""Numerical: standard deviation of a parameter that the user holds, over the larger of the value and 1."""
Z_Q_STD = 0.1
"""Prior standard deviation of Z_q, without unit. C_Lq of 10 gives 0.03 to 0.1 for aircraft of 3 kg to 8 t."""
LIFT_OVER_MOMENT_S = 0.02
"""Prior standard deviation of Z_δe/M_δe, s. Published estimates give 0.008 (twin jet) and 0.010 (twin
turboprop)."""
COEFFICIENT_STD = {"M_alpha": 1.5, "M_q": 20.0}
"""Prior standard deviation of C_mα and C_mq about zero, for hills of a posterior, and for a search without a
measured angle of attack. Published values are -0.3 to -1.8 and -10 to -25 for manned aircraft, and -2.7 and
-38 for an unmanned one of 13 kg."""


def precision(problem: OutputErrorProblem, shared: FloatArray) -> FloatArray:
    """Return the inverse prior variances of the shared parameters about zero.

    Parameters
    ----------
    shared
        Shape (7,): parameters in the order of ``SHARED``; M_δe scales the prior of Z_δe.

    Returns
    -------
    FloatArray
        Shape (7,): inverse prior variances. All are zero if every record has an angle of attack.
    """
    if all("alpha" in record.outputs for record in problem.records):
        return np.zeros(N_SHARED)
    weight = precision_without_alpha(shared)
    for name, size in problem.per_coefficient.items():
        weight[SHARED.index(name)] = (COEFFICIENT_STD[name] * size) ** -2
    return weight


def usual_moments(problem: OutputErrorProblem, theta: FloatArray) -> float:
    """Return -2 log density of usual C_mα and C_mq, for parameters ``theta`` (8,); 0 without a geometry.

    A measured angle of attack determines both near an optimum, but not which of two exchanged poles is the
    servo's. In a search without it, both priors are part of the search.
    """
    if not all("alpha" in record.outputs for record in problem.records):
        return 0.0
    sizes = problem.per_coefficient.items()
    return sum((float(theta[PARAMETERS.index(name)]) / (COEFFICIENT_STD[name] * x)) ** 2 for name, x in sizes)


def precision_without_alpha(shared: FloatArray) -> FloatArray:
    """Return inverse prior variances without a measured angle of attack, shape (7,), for ``shared`` (7,)
    parameters."""
    weight = np.zeros(N_SHARED)
    moment = max(abs(float(shared[SHARED.index("M_delta_e")])), 1e-6)
    weight[SHARED.index("Z_q")] = Z_Q_STD**-2
    weight[SHARED.index("Z_delta_e")] = (LIFT_OVER_MOMENT_S * moment) ** -2
    return weight


@dataclass(frozen=True, slots=True)
class Priors:
    """Gaussian priors of the derivatives of an axis."""

    mean: FloatArray
    """(s,)."""
    std: FloatArray
    """Shape (s,): prior standard deviations, infinite without a prior."""
    share: float | None = 1.0
    """Factor on ``std`` in a white-noise fit, as in ``extra.Prior``; None if the prior has no error."""

    @property
    def precision(self) -> FloatArray:
        """Shape (s,): inverse variances of the priors in a white-noise fit."""
        return np.asarray((self.std * (self.share or 1.0)) ** -2)


def about_zero(precision: FloatArray) -> Priors:
    """Return priors about zero with the inverse variances ``precision`` (k,), and without an error."""
    std = np.full(len(precision), np.inf)
    finite = precision > 0.0
    std[finite] = precision[finite] ** -0.5
    return Priors(np.zeros(len(precision)), std, None)
