"""A fit whitened by the filter of moving air and coloured instruments: likelihood, next step and errors.

The filter whitens residuals and sensitivities alike. The nuisance parameters are eliminated manoeuvre by
manoeuvre.
"""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import N_PARAMETERS, Index
from advisor.oem.arrow import inverse_of
from advisor.oem.innovations import AirModel, gains_of
from advisor.oem.kalman import Gains
from advisor.oem.place import Linearization, in_time, speeds_of, system_of
from advisor.oem.prior import precision


@dataclass(frozen=True, slots=True)
class Whitened:
    """A whitened fit with nuisance parameters eliminated."""

    cost: float
    """-2 log likelihood up to a constant, including the prior."""
    step: FloatArray
    """(n,) step of the free shared and instrument parameters."""
    own_steps: tuple[FloatArray, ...]
    """Step of each manoeuvre's free nuisance parameters."""
    std: FloatArray
    """(n,) Cramér-Rao standard deviations."""

    @property
    def pending(self) -> float:
        """Largest pending step, in standard deviations."""
        return float(np.max(np.abs(self.step) / self.std))


def whitened(place: Linearization, air: AirModel) -> Whitened | None:
    """Return the whitened fit; None where numbers overflow."""
    common, own = place.assembly.common, place.assembly.own
    n = len(common) + len(place.extra)
    prior = precision(place.problem, place.shared)[common]
    information, gradient = np.zeros((n, n)), np.zeros(n)
    extra = place.extra
    information += np.diag(np.concatenate([prior, extra.weight**2]))
    gradient += np.concatenate([-prior * place.shared[common], extra.weight * extra.pull])
    cost, parts = float(np.sum(prior * place.shared[common] ** 2)) + extra.penalty, []
    columns = np.column_stack([place.residual, place.sensitivities, extra.columns])
    shared_columns = [*(1 + common), *range(1 + N_PARAMETERS, 1 + N_PARAMETERS + len(extra))]
    for order, gains in gains_along(place, air):
        white = gains.innovations(columns[order])
        residual, mine = white[:, 0], white[:, shared_columns]
        basis, triangle = np.linalg.qr(white[:, 1 + own])
        kept, rest = mine - basis @ (basis.T @ mine), residual - basis @ (basis.T @ residual)
        information += kept.T @ kept
        gradient += kept.T @ rest
        cost += 2.0 * float(np.sum(np.log(gains.root))) + float(rest @ rest)
        parts.append((basis, triangle, mine, residual))
    if not (np.all(np.isfinite(information)) and np.isfinite(cost)):
        return None
    covariance, _ = inverse_of(information)
    step = covariance @ gradient
    own_steps = tuple(
        np.asarray(np.linalg.lstsq(triangle, basis.T @ (residual - mine @ step), rcond=1e-10)[0])
        for basis, triangle, mine, residual in parts
    )
    return Whitened(cost, step, own_steps, np.sqrt(np.diag(covariance)))


def gains_along(place: Linearization, air: AirModel) -> list[tuple[Index, Gains]]:
    """Return for each manoeuvre its rows in order of time, and the filter's gains along them."""
    problem, found = place.problem, []
    for m, speed in enumerate(speeds_of(problem)):
        system = np.append(system_of(place.shared, speed / (problem.reference_airspeed_m_s or speed)), speed)
        order = in_time(place.assembly, m)
        arms = (problem.vane_arm_m, problem.accelerometer_arm_m)
        # The fit has its own initial states, so the filter starts without uncertainty.
        gains = gains_of(
            place.assembly.t[order], place.assembly.channel[order], system, air, 0.0, arms_m=arms
        )
        found.append((order, gains))
    return found
