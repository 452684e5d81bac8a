"""Log likelihood that the terms of the user gain, by fits with and without each of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.added_term import AddedTerm
from advisor.aircraft.aircraft import Aircraft
from advisor.oem.estimate import TermEstimate
from advisor.oem.solution import Solution
from advisor.oem.weighing import Weighing


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
