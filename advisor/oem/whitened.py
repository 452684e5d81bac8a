"""A fit at one setting of all parameters, whitened by the filter of moving air and coloured instruments.

The filter whitens residuals and sensitivities. The nuisance parameters are eliminated manoeuvre by manoeuvre,
which gives the likelihood and the next step.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.model.outputs import N_PARAMETERS, SHARED
from advisor.model.response import Index, respond
from advisor.oem.arrow import inverse_of
from advisor.oem.extra import Extra
from advisor.oem.innovations import AirModel, gains_of
from advisor.oem.instruments import Instrument, extra_of
from advisor.oem.kalman import Gains
from advisor.oem.prior import precision
from advisor.oem.problem import ASSUMED_M_S, Assembly, OutputErrorProblem, assemble
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Linearization:
    """A setting of all parameters, with its residuals and sensitivities."""

    problem: OutputErrorProblem
    assembly: Assembly
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    """Shape (N,): residuals of the outputs."""
    sensitivities: FloatArray
    """Shape (N, 14): sensitivities of the outputs to the parameters."""
    extra: Extra
    """Instrument parameters of the setting."""


def at(
    problem: OutputErrorProblem, shared: FloatArray, local: FloatArray, instruments: Sequence[Instrument]
) -> Linearization | None:
    """Return the residuals at ``shared`` (7,) and ``local`` (m, 7) parameters; None on numerical overflow."""
    assembly = assemble(problem)
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    if not respond(assembly.grid, shared, local, y, g):
        return None
    extra = extra_of(problem, assembly, shared, local, instruments)
    return Linearization(problem, assembly, shared, local, assembly.z - y, g, extra)


def in_time(assembly: Assembly, m: int) -> Index:
    """Return the rows of manoeuvre ``m`` in order of time, shape (n,)."""
    rows = assembly.blocks[m]
    return np.asarray(rows.start + np.argsort(assembly.t[rows], kind="stable"))


def speeds_of(problem: OutputErrorProblem) -> list[float]:
    """Return the mean air speed of each manoeuvre, m/s."""
    speeds = [record.airspeed for record in problem.records]
    return [ASSUMED_M_S if speed is None else float(np.mean(speed.y)) for speed in speeds]


def system_of(shared: FloatArray, ratio: float) -> FloatArray:
    """Return Z_α, Z_q, M_α, M_q at an air speed of ``ratio`` times the reference, shape (4,)."""
    z_a, z_q, m_a, m_q = (shared[SHARED.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    return np.array([ratio * z_a, z_q, ratio**2 * m_a, ratio * m_q])


@dataclass(frozen=True, slots=True)
class Whitened:
    """A whitened fit with nuisance parameters eliminated."""

    cost: float
    """-2 log likelihood up to a constant, including the prior."""
    step: FloatArray
    """Shape (n,): step of the free shared parameters and of the instruments."""
    own_steps: tuple[FloatArray, ...]
    """Step of each manoeuvre's free nuisance parameters."""
    std: FloatArray
    """Shape (n,): Cramér-Rao standard deviations."""

    @property
    def pending(self) -> float:
        """Largest pending step of any parameter, in standard deviations."""
        return float(np.max(np.abs(self.step) / self.std))


def whitened(place: Linearization, air: AirModel) -> Whitened | None:
    """Return the whitened fit; None on numerical overflow."""
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
    """Return each manoeuvre's rows in order of time, and the filter gains along them."""
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
