"""Solution of a problem: start, descent, errors, and identifiability."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.model.axis import Names
from advisor.model.short_period import NAMES
from advisor.oem.estimate import NoEstimate
from advisor.oem.evaluation import Evaluated, errors_of
from advisor.oem.extra import Extra
from advisor.oem.gauss_newton import CONVERGED, FLAT, LEAST_NOISE, OVERFLOW, SINGULAR, Optimum, descend
from advisor.oem.prior import Priors, precision
from advisor.oem.problem import Assembly, OutputErrorProblem, assemble
from advisor.oem.rows import Laid
from advisor.oem.start import start
from advisor.process.arrays import FloatArray

RUNS_AWAY = NoEstimate(
    "diverged", "The model runs away from its first guess: the record is too long or too noisy."
)
NOTHING_TO_TELL = NoEstimate(
    "singular", "The input does not excite the motion enough to distinguish the parameters."
)
HEALTHY_ITERATIONS = 12
"""Largest number of iterations of a normal search. A longer search may be in the valley of a second minimum,
so another start is tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution(Evaluated):
    """Optimum of one problem of any axis, with all derived quantities."""

    problem: Any
    assembly: Any
    parameters: Sequence[Any] = ()
    """Nuisance parameters of the search, each with a name. Their derivatives are the first columns of
    ``extra``."""
    alike: FloatArray | None = None
    """Shape (m, 1 + p + k): optima along a servo's lag that explain the record alike, this one first. Each
    row has the lag, s, then all parameters. None for one optimum."""

    @property
    def residual(self) -> FloatArray:
        """Shape (N,): residual ν̂ = z - ŷ, Eq. (9)."""
        return np.asarray(self.assembly.z - self.fitted)

    @property
    def cost(self) -> float:
        """Cost J = σ_α²·σ_q², Eq. (7); σ_q²·σ_az² without an angle of attack; σ_p²·σ_r² of roll and yaw."""
        first, second = self.optimum.noise[self.optimum.noise > 0.0][:2]
        return float((first * second) ** 2)

    @property
    def nuisances(self) -> Mapping[str, tuple[float, float]]:
        """Value and standard deviation of each nuisance parameter, in its unit, by its name."""
        std = np.sqrt(np.diag(self.widened))[len(self.theta) :]
        pairs = zip(self.parameters, std, strict=False)
        return {x.name: (x.read(self.problem), float(s)) for x, s in pairs}


def solve(
    problem: OutputErrorProblem, *, begin: tuple[FloatArray, FloatArray] | None = None
) -> Solution | NoEstimate:
    """Estimate the parameters of a short-period problem.

    Parameters
    ----------
    begin : shared (7,) and local (m, 7) parameters to start from, e.g. of an earlier, shorter
        solution; by default the regression of ``start``.
    """
    assembly, optimum = search(problem, begin=begin)
    return refused(optimum) or evaluate(problem, assembly, optimum)


def refused(optimum: Optimum) -> NoEstimate | None:
    """Return the reason why a search found no optimum; None for a successful search."""
    if optimum.status == OVERFLOW:
        return RUNS_AWAY
    if optimum.status == SINGULAR:
        return NOTHING_TO_TELL
    if optimum.status != CONVERGED:
        text = (
            f"The search for the best fit did not converge in {optimum.iterations} iterations:"
            " very different values explain this record equally well."
        )
        return NoEstimate("not_converged", text)
    return None


def search(
    problem: OutputErrorProblem, *, begin: tuple[FloatArray, FloatArray] | None = None, flat: float = FLAT
) -> tuple[Assembly, Optimum]:
    """Return the optimum of a problem, whatever its status.

    Parameters
    ----------
    begin : parameters to start from, as in ``solve``.
    flat : promised change of log J per sample at which Gauss-Newton stops.
    """
    assembly = assemble(problem)
    floor = noise_floor(assembly)
    data = (assembly.grid, assembly.z, assembly.channel, assembly.owner, assembly.free, floor)

    def from_(shared: FloatArray, local: FloatArray) -> Optimum:
        return descend(*data, precision(problem, shared), shared, local, flat)

    optimum = from_(*problem.holding(*(start(problem) if begin is None else begin)))
    if begin is None and (optimum.status != CONVERGED or optimum.iterations > HEALTHY_ITERATIONS):
        other = from_(*problem.holding(*start(problem, lift_from_alpha_only=True)))
        if other.log_likelihood_cost < optimum.log_likelihood_cost:
            optimum = other
    return assembly, optimum


def evaluate(
    problem: Any,
    assembly: Laid,
    optimum: Optimum,
    extra: Extra | None = None,
    kept: int | None = None,
    *,
    prior: Priors | None = None,
    parameters: Sequence[Any] = (),
    final: bool = True,
) -> Solution | NoEstimate:
    """Return the solution at an optimum, with its errors.

    Parameters
    ----------
    extra, kept : arguments of ``evaluation.errors_of``.
    prior : priors of the derivatives, whose errors count. None: the priors of the short period, whose errors
        do not.
    final : whether the errors contain dynamics that the model lacks; a solution on the way to another one
        needs none.
    """
    errors = errors_of(
        assembly,
        assembly.z - optimum.fitted,
        optimum.sensitivities,
        optimum.noise,
        extra,
        precision(problem, optimum.shared) if prior is None else prior.precision,
        fitted=optimum.fitted if final else None,
        prior_share=None if prior is None else prior.share,
        kept=kept,
    )
    if errors is None:
        return NOTHING_TO_TELL
    theta = reported(optimum.shared, optimum.local, assembly.names)
    parts = {"theta": theta, "extra": extra, "parameters": parameters, **errors}
    return Solution(problem=problem, assembly=assembly, optimum=optimum, **parts)


def reported(shared: FloatArray, local: FloatArray, names: Names = NAMES) -> FloatArray:
    """Return the reported parameters, shape (p,), from the shared (s,) and local (m, l) parameters."""
    mean = local.mean(axis=0)
    return np.array([shared[i] if is_shared else mean[i] for is_shared, i in names.places])


def noise_floor(assembly: Laid) -> FloatArray:
    """Return the smallest noise σ of each output, shape (outputs,), for noise-free data."""
    return np.maximum(LEAST_NOISE * spread_of(assembly), 1e-300)


def spread_of(assembly: Laid) -> FloatArray:
    """Return the standard deviation of each output's measurements, shape (outputs,)."""
    outputs = len(assembly.names.outputs)
    count = np.maximum(np.bincount(assembly.channel, minlength=outputs), 1)
    mean = np.bincount(assembly.channel, assembly.z, outputs) / count
    deviation = assembly.z - mean[assembly.channel]
    return np.asarray(np.sqrt(np.bincount(assembly.channel, deviation**2, outputs) / count))
