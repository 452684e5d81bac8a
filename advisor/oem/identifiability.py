"""Identifiability: which parameters an input determines, and what a joint search gains. A good fit proves
neither.

A parameter can be undetermined in three ways, each with its own sentence:

- The data do not contain the parameter (a singular direction of the information matrix).
- The elevator followed angle of attack and pitch rate in a closed loop: δe = k₀ + k₁·α + k₂·q satisfies
  (1)-(2) for a whole plane of derivatives. The command's motion between its stamps then decides which
  derivatives fit best.
- The corrected error is as large as the typical size of such a derivative on this aircraft.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.added_term import AddedTerm
from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.model.short_period import ShortPeriod
from advisor.oem.correlation import HIGH_CORRELATION, correlation_matrix
from advisor.oem.covariance import Weighing
from advisor.oem.estimate import TermEstimate
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

LARGEST_ERROR = 0.5
"""Largest corrected standard deviation over the parameter's natural size, for a usable value."""
LEAST_OWN_MOTION = 0.02
"""Least RMS elevator motion that no feedback explains, as a share of the whole motion."""
LEVEL_UNKNOWN = "not identifiable without a measured angle of attack, whose offset it depends on"


def natural_size(theta: FloatArray) -> Mapping[str, float]:
    """Return the typical size of each derivative for an aircraft with these poles and this control power.

    Rates ω = max(√|det A|, |tr A|/2) give the size of Z_α and M_q, and ω² gives that of M_α. The size of M_δe
    is the control power. The size of Z_δe is the lift that turns the path as fast as M_δe does within 1/ω.
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


def not_identifiable(solution: Solution) -> dict[str, str]:
    """Return the reason why a parameter has no usable value, by the parameter's name."""
    reasons = dict.fromkeys(
        solution.influence.unresolved, "not identifiable from this input: the record does not depend on it"
    )
    if not all("alpha" in record.outputs for record in solution.problem.records):
        reasons |= dict.fromkeys(("Z_0", "M_0"), LEVEL_UNKNOWN)
    own = own_motion(solution)
    if own < LEAST_OWN_MOTION:
        text = (
            "not identifiable from this input: a closed loop moved the elevator with angle of attack and"
            f" pitch rate; only {100.0 * own:.1f} % of its motion is independent of them"
        )
        reasons = dict.fromkeys(natural_size(solution.theta), text) | reasons
    return too_wide(solution.theta, np.sqrt(np.diag(solution.scattered))) | reasons


def too_wide(theta: FloatArray, std: FloatArray) -> dict[str, str]:
    """Return the reason why a parameter of ``theta`` (8,) with error ``std`` (8,) has no usable value, by
    name."""
    reasons = {}
    for name, size in natural_size(theta).items():
        error = float(std[PARAMETERS.index(name)])
        if not error <= LARGEST_ERROR * size:
            reasons[name] = (
                f"not identifiable from this input: its error ±{NORMAL_95 * error:.3g} is as large"
                f" as such a derivative can be here ({size:.3g})"
            )
    return reasons


def own_motion(solution: Solution) -> float:
    """Return the share of the command's motion, root mean square, that no feedback of α and q explains."""
    assembly, fitted = solution.assembly, solution.fitted
    motion, feedback = [], []
    for record, rows in zip(solution.problem.records, assembly.rows, strict=True):
        lift, q = rows["alpha" if "alpha" in rows else "a_z"], rows["q"]
        at_q = np.interp(assembly.t[q], assembly.t[lift], fitted[lift])
        states = np.column_stack([at_q, fitted[q]])
        command = record.elevator.at(assembly.t[q])
        motion.append(command - command.mean())
        feedback.append(states - states.mean(axis=0))
    moved, followed = np.concatenate(motion), np.concatenate(feedback)
    left = moved - followed @ np.linalg.lstsq(followed, moved, rcond=None)[0]
    size = float(np.linalg.norm(moved))
    return float(np.linalg.norm(left)) / size if size > 0.0 else 1.0


def correlated(
    covariance: FloatArray, names: Sequence[str] = PARAMETERS
) -> tuple[tuple[str, str, float], ...]:
    """Return pairs of parameters whose errors are correlated above ``HIGH_CORRELATION``."""
    correlation = correlation_matrix(covariance)
    return tuple(
        (names[i], names[j], float(correlation[i, j]))
        for i in range(len(names))
        for j in range(i + 1, len(names))
        if abs(correlation[i, j]) > HIGH_CORRELATION
    )


def log_likelihood(solution: Solution) -> float:
    """Return the log likelihood of a solution under its own coloured noise, up to a constant, nats.

    The last step of all parameters, by generalised least squares, is part of the likelihood.
    """
    laid = solution.assembly
    weighing = Weighing.by(solution.noise.colours, laid)
    extra = [] if solution.extra is None else [solution.extra.columns]
    shared = np.column_stack([solution.sensitivities[:, laid.common], *extra])
    white = weighing.forward(np.column_stack([solution.residual, shared]))
    own = weighing.forward(solution.sensitivities[:, laid.own])
    for rows in laid.blocks:
        basis, _ = np.linalg.qr(own[rows])
        white[rows] -= basis @ (basis.T @ white[rows])
    step = np.linalg.lstsq(white[:, 1:], white[:, 0], rcond=None)[0]
    left = white[:, 0] - white[:, 1:] @ step
    return -0.5 * (float(left @ left) + weighing.volume)


def told(
    terms: Sequence[AddedTerm], values: Mapping[str, tuple[float, float]], with_it: Solution,
    without: Callable[[str], Solution | None],
) -> tuple[TermEstimate, ...]:  # fmt: skip
    """Return the coefficients of the user's terms that a fit has, each with the log likelihood that it gains.

    Parameters
    ----------
    values
        Value and standard deviation of each coefficient, by its term.
    without
        Function that returns the solution without one term; None without such a solution.
    """
    estimates = []
    for name in (term.name for term in terms if term.name in values):
        other = without(name)
        gained = np.nan if other is None else log_likelihood(with_it) - log_likelihood(other)
        estimates.append(TermEstimate(name, *values[name], gained))
    return tuple(estimates)


def without_term(aircraft: Aircraft, term: str) -> Aircraft:
    """Return the aircraft without one of its added terms."""
    structure = aircraft.estimation
    kept = tuple(text for text in structure.terms if text != term)
    return replace(aircraft, estimation=replace(structure, terms=kept))


def without_terms(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft without any added term."""
    return replace(aircraft, estimation=replace(aircraft.estimation, terms=()))
