"""Which parameters this input tells, and which it does not. A good fit is no proof of either.

Four ways to lose a parameter, each with its own sentence:

- the data say nothing about it at all (a singular direction of the information matrix);
- the elevator followed angle of attack and pitch rate, as a closed loop moves it: δe = k₀ + k₁·α + k₂·q makes
  (1)-(2) hold for a whole plane of derivatives, and which of them fits best is decided by how the command
  runs between its stamps;
- its corrected error is as large as the size such a derivative has on this aircraft;
- the servo is unknown, and a lag too small to be seen in the fit would change the value beyond
  use. That is how an over-damped aircraft fails, where α, q and δe move together.
"""

import math
from collections.abc import Mapping

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.model.short_period import ShortPeriod
from advisor.oem.solution import Solution

HIGH_CORRELATION = 0.9
LARGEST_ERROR = 0.5
"""Corrected standard deviation over the natural size of the parameter."""
LARGEST_SHIFT = 0.5
"""Change with the lag below over the new value or the natural size, whichever is larger."""
LEAST_OWN_MOTION = 0.02
"""Root mean square of the elevator's motion that no feedback explains, as a share of all of it."""
LEVEL_UNKNOWN = "not identifiable without a measured angle of attack, whose level it goes with"
SUPPOSED_LAG_S = 0.05
"""A servo lag nobody would notice in the fit."""


def natural_size(theta: FloatArray) -> Mapping[str, float]:
    """Return how large each derivative is on an aircraft with these poles and this control power.

    Rates ω = max(√|det A|, |tr A|/2) set Z_α and M_q, their square M_α; control is measured
    by M_δe, and by the lift Z_δe that turns the path as fast as M_δe does within 1/ω.
    """
    a = ShortPeriod(theta).a
    rate = max(math.sqrt(abs(float(np.linalg.det(a)))), abs(float(np.trace(a))) / 2.0)
    power = abs(float(theta[PARAMETERS.index("M_delta_e")]))
    return {
        "Z_alpha": rate,
        "Z_q": 1.0,
        "Z_delta_e": power / rate if rate > 0.0 else math.inf,
        "M_alpha": rate**2,
        "M_q": rate,
        "M_delta_e": power,
    }


def not_identifiable(solution: Solution, lagged: FloatArray | None) -> dict[str, str]:
    """Return parameter name to the reason why it has no usable value.

    Parameters
    ----------
    lagged : (8,) the estimate under ``SUPPOSED_LAG_S`` of servo lag, when the servo is unknown.
    """
    reasons = dict.fromkeys(
        solution.influence.unresolved, "not identifiable from this input: the record does not depend on it"
    )
    if not all("alpha" in record.outputs for record in solution.problem.records):
        reasons |= dict.fromkeys(("Z_0", "M_0"), LEVEL_UNKNOWN)
    std = np.sqrt(np.diag(solution.covariance))
    sizes = natural_size(solution.theta)
    own = own_motion(solution)
    if own < LEAST_OWN_MOTION:
        text = (
            "not identifiable from this input: the elevator followed angle of attack and pitch rate, as a"
            f" closed loop moves it; only {100.0 * own:.1f} % of its motion was its own"
        )
        reasons = dict.fromkeys(sizes, text) | reasons
    for name, size in sizes.items():
        j = PARAMETERS.index(name)
        if name not in reasons and not std[j] <= LARGEST_ERROR * size:
            reasons[name] = (
                f"not identifiable from this input: its error ±{std[j]:.3g} is as large as"
                f" such a derivative can be here ({size:.3g})"
            )
    if lagged is not None:
        moment = {name: PARAMETERS.index(name) for name in ("M_alpha", "M_delta_e", "M_q")}
        shifted = [
            name
            for name, j in moment.items()
            if not abs(lagged[j] - solution.theta[j]) <= LARGEST_SHIFT * max(abs(lagged[j]), sizes[name])
        ]
        # M_q trades with a lag on every aircraft; it is lost only where stiffness or control are, too.
        for name in shifted if shifted != ["M_q"] else []:
            value, moved = solution.theta[moment[name]], lagged[moment[name]]
            if name not in reasons:
                reasons[name] = (
                    "not identifiable from this input while the servo is unknown: a lag of"
                    f" {SUPPOSED_LAG_S:g} s would turn {value:.3g} into {moved:.3g}; set elevator.lag_s"
                )
    return reasons


def own_motion(solution: Solution) -> float:
    """Return the share of the elevator's motion, root mean square, that one feedback of α and q leaves
    unexplained."""
    assembly, fitted = solution.assembly, solution.fitted
    measured = assembly.grid.row[OUTPUTS.index("q")] >= 0
    elevator = np.empty(len(fitted))
    elevator[assembly.grid.row[OUTPUTS.index("q")][measured]] = assembly.grid.elevator[measured]
    motion, feedback = [], []
    for rows in assembly.rows:
        lift, q = rows["alpha" if "alpha" in rows else "a_z"], rows["q"]
        at_q = np.interp(assembly.t[q], assembly.t[lift], fitted[lift])
        states = np.column_stack([at_q, fitted[q]])
        motion.append(elevator[q] - elevator[q].mean())
        feedback.append(states - states.mean(axis=0))
    moved, followed = np.concatenate(motion), np.concatenate(feedback)
    left = moved - followed @ np.linalg.lstsq(followed, moved, rcond=None)[0]
    size = float(np.linalg.norm(moved))
    return float(np.linalg.norm(left)) / size if size > 0.0 else 1.0


def correlated(covariance: FloatArray) -> tuple[tuple[str, str, float], ...]:
    """Return pairs of parameters whose errors are correlated above ``HIGH_CORRELATION``."""
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    correlation = covariance / np.outer(scale, scale)
    return tuple(
        (PARAMETERS[i], PARAMETERS[j], float(correlation[i, j]))
        for i in range(len(PARAMETERS))
        for j in range(i + 1, len(PARAMETERS))
        if abs(correlation[i, j]) > HIGH_CORRELATION
    )
