"""Solution of a problem: start, descent, errors, and identifiability."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import OUTPUTS
from advisor.oem.covariance import REPORTED, Coloured
from advisor.oem.estimate import NoEstimate
from advisor.oem.evaluation import Evaluated, errors_of
from advisor.oem.extra import Extra
from advisor.oem.gauss_newton import CONVERGED, FLAT, LEAST_NOISE, OVERFLOW, SINGULAR, Optimum, descend
from advisor.oem.prior import precision
from advisor.oem.problem import Assembly, OutputErrorProblem, assemble
from advisor.oem.rows import Laid
from advisor.oem.start import start

NOTHING_TO_TELL = "The input does not excite the motion enough to distinguish the parameters."
RUNS_AWAY = NoEstimate(
    "diverged", "The model runs away from its first guess: the record is too long or too noisy."
)
HEALTHY_ITERATIONS = 12
"""Largest number of iterations of a normal search. A longer search may be in the valley of a second minimum,
so another start is tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution(Evaluated):
    """Optimum of one short-period problem, with all derived quantities."""

    problem: OutputErrorProblem
    assembly: Assembly

    @property
    def residual(self) -> FloatArray:
        """Shape (N,): residual ν̂ = z - ŷ, Eq. (9)."""
        return self.assembly.z - self.fitted

    @property
    def cost(self) -> float:
        """Cost J = σ_α²·σ_q², Eq. (7); σ_q²·σ_az² without an angle of attack."""
        noise = dict(zip(OUTPUTS, self.optimum.noise, strict=True))
        other = "alpha" if noise["alpha"] > 0.0 else "a_z"
        return float((noise["q"] * noise[other]) ** 2)


def solve(
    problem: OutputErrorProblem,
    *,
    begin: tuple[FloatArray, FloatArray] | None = None,
    noise: Coloured | None = None,
    flat: float = FLAT,
) -> Solution | NoEstimate:
    """Estimate the parameters of a short-period problem.

    Parameters
    ----------
    begin : shared (7,) and local (m, 7) parameters to start from, e.g. of an earlier, shorter
        solution; by default the regression of ``start``.
    noise : noise model of a recent solution, which is used instead of a new fit.
    flat : promised change of log J per sample at which Gauss-Newton stops.
    """
    assembly, optimum = search(problem, begin=begin, flat=flat)
    return refused(optimum, NOTHING_TO_TELL) or evaluate(problem, assembly, optimum, noise=noise)


def refused(optimum: Optimum, nothing_to_tell: str) -> NoEstimate | None:
    """Return the reason why a search found no optimum; None for a successful search.

    ``nothing_to_tell`` is the sentence for an input that does not excite the motion enough.
    """
    if optimum.status == OVERFLOW:
        return RUNS_AWAY
    if optimum.status == SINGULAR:
        return NoEstimate("singular", nothing_to_tell)
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
    """Return the optimum of a problem, whatever its status, for the arguments of ``solve``."""
    assembly = assemble(problem)
    floor = noise_floor(assembly)
    data = (assembly.grid, assembly.z, assembly.channel, assembly.owner, assembly.free, floor)

    def from_(shared: FloatArray, local: FloatArray) -> Optimum:
        return descend(*data, precision(problem, shared), shared, local, flat)

    optimum = from_(*(start(problem) if begin is None else begin))
    if begin is None and (optimum.status != CONVERGED or optimum.iterations > HEALTHY_ITERATIONS):
        other = from_(*start(problem, lift_from_alpha_only=True))
        if other.log_likelihood_cost < optimum.log_likelihood_cost:
            optimum = other
    return assembly, optimum


def evaluate(
    problem: OutputErrorProblem,
    assembly: Assembly,
    optimum: Optimum,
    extra: Extra | None = None,
    noise: Coloured | None = None,
    kept: int | None = None,
) -> Solution | NoEstimate:
    """Return the solution at an optimum, with its errors.

    Parameters
    ----------
    extra, noise, kept : arguments of ``evaluation.errors_of``.
    """
    residual, prior = assembly.z - optimum.fitted, precision(problem, optimum.shared)
    errors = errors_of(
        assembly,
        residual,
        optimum.sensitivities,
        optimum.noise,
        extra,
        prior,
        fitted=optimum.fitted,
        noise=noise,
        kept=kept,
    )
    if errors is None:
        return NoEstimate("singular", NOTHING_TO_TELL)
    theta = reported(optimum.shared, optimum.local)
    return Solution(problem=problem, assembly=assembly, optimum=optimum, theta=theta, extra=extra, **errors)


def reported(shared: FloatArray, local: FloatArray) -> FloatArray:
    """Return the eight reported parameters, in the order of ``PARAMETERS``, from the solver's parameters."""
    mean = local.mean(axis=0)
    return np.array([shared[i] if is_shared else mean[i] for is_shared, i in REPORTED])


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
