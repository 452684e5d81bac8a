"""Estimates of thousands of simulated manoeuvres on one time grid, for studies of an input's information.

All manoeuvres share input and stamps and differ only in their measurements. The time grid is laid out once,
and all further computations are compiled.
"""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import N_SHARED
from advisor.model.response import Index
from advisor.oem.covariance import REPORTED
from advisor.oem.each import solve_each
from advisor.oem.estimate import NoEstimate
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import noise_floor, solve
from advisor.process.arrays import FloatArray

_POSITION = np.array([index if is_shared else N_SHARED + index for is_shared, index in REPORTED])
"""Index of each of the eight reported parameters among all parameters."""


@dataclass(frozen=True, slots=True)
class Batch:
    """Estimates of simulated manoeuvres, one manoeuvre per row. A row without an estimate is NaN."""

    theta: FloatArray
    """Shape (n, 8): parameters in the order of ``PARAMETERS``."""
    std_cr: FloatArray
    """Shape (n, 8): Cramér-Rao standard deviations."""
    noise: FloatArray
    """Shape (n, 2): noise σ of alpha and q."""
    iterations: Index
    """(n,)."""

    @property
    def cost(self) -> FloatArray:
        """Shape (n,): cost J = σ_α²·σ_q², Eq. (7)."""
        return np.asarray(np.prod(self.noise**2, axis=1))

    @property
    def failed(self) -> int:
        """Number of rows without an estimate."""
        return int(np.count_nonzero(np.isnan(self.theta[:, 0])))


def solve_many(elevator: Signal, t: FloatArray, alpha: FloatArray, q: FloatArray) -> Batch:
    """Estimate the parameters of every row separately.

    Parameters
    ----------
    elevator : the input all rows share.
    t : (k,) stamps of both outputs.
    alpha, q : (n, k) measurements.

    Every search begins at the estimate of the rows' mean, or after a failure at the row's regression.
    """

    def problem(a: FloatArray, b: FloatArray) -> OutputErrorProblem:
        return OutputErrorProblem((Record(elevator, {"alpha": Signal(t, a), "q": Signal(t, b)}),))

    mean = solve(problem(alpha.mean(axis=0), q.mean(axis=0)))
    first = solve(problem(alpha[0], q[0])) if isinstance(mean, NoEstimate) else mean
    if isinstance(first, NoEstimate):
        nothing = np.full((len(alpha), len(PARAMETERS)), np.nan)
        return Batch(nothing, nothing, nothing[:, :2], np.zeros(len(alpha), np.int64))
    assembly = assemble(problem(alpha[0], q[0]))
    z = np.ascontiguousarray(np.concatenate([alpha, q], axis=1))
    theta, bounds, noise, iterations = solve_each(
        assembly.grid,
        z,
        assembly.channel,
        assembly.owner,
        assembly.free,
        noise_floor(assembly),
        first.optimum.shared,
        first.optimum.local,
        _POSITION,
    )
    for i in np.flatnonzero(iterations < 0):
        again = solve(problem(alpha[i], q[i]))
        if not isinstance(again, NoEstimate):
            theta[i] = again.theta
            bounds[i] = np.sqrt(np.diag(again.covariance_cr))
            noise[i] = again.optimum.noise[:2]
        iterations[i] = 0 if isinstance(again, NoEstimate) else again.optimum.iterations
    return Batch(theta, bounds, noise, iterations)
