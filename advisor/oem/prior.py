"""Priors of derivatives that a record may not determine.

*Short period.* Without a vane, Z_q and Z_δe are correlated with Z_α in pitch rate and specific force. Priors
of usual size bound Z_q, M_α, M_q and Z_δe:

- Z_q = -ρ·S·c·C_Lq/(4·m) is the lift due to pitch rate, relative to the turn rate of the path;
- M_α and M_q are those of usual coefficients, where the file states wing, chord and inertia;
- Z_δe/M_δe = k_y²/(l_t·V): the tail's lift turns the path by its force and the nose by its moment, with k_y
  the radius of gyration and l_t the tail's lever.

*Lateral axis.*

- Y_p = ρ·S·b·C_Yp/(4·m), and likewise Y_r, are a few per cent on every aircraft.
- The derivatives of a control that hardly moves have the size of those of the other control, with mean zero.
- Without a lateral acceleration and a sideslip, the motion alone determines neither the side force nor the
  sideslip. In level flight Y_β = -(g/V)·|C_Yβ|/C_L, so that gravity and air speed give its size. Strip theory
  gives N_p/L_p = (C_np/C_lp)·(I_xx/I_zz) and L_r/L_p = C_lr/C_lp (Etkin & Reid, *Dynamics of Flight*, Ch. 5).
"""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axes.lateral import CONTROLS, LATERAL, natural_size
from advisor.model.outputs import N_SHARED, SHARED
from advisor.oem.axes.lateral.problem import LateralProblem
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
SIDE_FORCE_STD = 0.05
"""Prior standard deviation of Y_p and Y_r about zero, without unit. C_Yp and C_Yr of 0.4 give 0.01 for a jet
of 15 t and 0.04 for an aircraft of 3 kg."""
SIDE_FORCE_OVER_WEIGHT = 2.0
"""Prior mean and standard deviation of |C_Yβ|/C_L, without unit. Fits give -Y_β·V/g of 0.8 on an indoor
aircraft, 1.2 at 3 kg, 2.7 on a jet and 4.9 on a fighter."""
YAW_BY_ROLLING = 0.2
"""Prior standard deviation of N_p over L_p, without unit. C_np of C_L/8 with C_lp of -0.45 gives 0.03 to 0.2.
Fits give 0.01 on a fighter, 0.05 on a jet, 0.09 at 3 kg and -0.3 on an indoor aircraft."""
ROLL_BY_YAWING = 1.0
"""Prior standard deviation of L_r over L_p, without unit. C_lr of C_L/4 with C_lp of -0.45 gives 0.2 to 0.8.
Fits give 0.2 on a fighter, 0.3 on a jet and at 3 kg, and 0.7 on an indoor aircraft."""


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
    """Gaussian priors of the lateral derivatives."""

    mean: FloatArray
    """(15,)."""
    std: FloatArray
    """Shape (15,): prior standard deviations, infinite without a prior."""
    share: float | None = 1.0
    """Factor on ``std`` in a white-noise fit, as in ``extra.Prior``; None if the prior has no error."""

    @property
    def precision(self) -> FloatArray:
        """Shape (15,): inverse variances of the priors in a white-noise fit."""
        return np.asarray((self.std * (self.share or 1.0)) ** -2)


def about_zero(precision: FloatArray) -> Priors:
    """Return priors about zero with the inverse variances ``precision`` (k,), and without an error."""
    std = np.full(len(precision), np.inf)
    finite = precision > 0.0
    std[finite] = precision[finite] ** -0.5
    return Priors(np.zeros(len(precision)), std, None)


def guessed_y_beta(problem: LateralProblem) -> float:
    """Return a typical Y_β, 1/s, for the records' air speed."""
    speed = float(np.mean([np.mean(record.airspeed.y) for record in problem.records]))
    return -SIDE_FORCE_OVER_WEIGHT * GRAVITY_M_S2 / speed


def priors_of(problem: LateralProblem, start: FloatArray) -> Priors:
    """Return the priors, scaled by the derivatives in ``start`` (15,)."""
    mean = dict.fromkeys(LATERAL.names.shared, 0.0)
    std = dict.fromkeys(LATERAL.names.shared, np.inf)
    std |= {"Y_p": SIDE_FORCE_STD, "Y_r": SIDE_FORCE_STD}
    size = natural_size(start)
    flown = [suffix for suffix, name in CONTROLS.items() if problem.flies(name)]
    for suffix in CONTROLS.keys() - flown:
        for letter in "YLN":
            usual = max((size[f"{letter}_{other}"] for other in flown), default=np.inf)
            std[f"{letter}_{suffix}"] = usual if usual > 0.0 else np.inf
    if not problem.tells_force:
        mean["Y_beta"] = guessed_y_beta(problem)
        std["Y_beta"] = -mean["Y_beta"]
        std |= {"N_p": YAW_BY_ROLLING * size["L_p"], "L_r": ROLL_BY_YAWING * size["L_p"]}
    return Priors(np.array(list(mean.values())), np.array(list(std.values())))
