"""Output error on the lateral axis: from records to derivatives, errors and identifiability.

The search, the influence of every measurement and the noise model are those of the short period. Y_p and Y_r
have priors: Y_p = ρ·S·b·C_Yp/(4·m), and likewise Y_r, are a few per cent on every aircraft.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.lateral import LATERAL, natural_size
from advisor.oem.between import widened_by_scatter
from advisor.oem.covariance import (
    Coloured,
    Influence,
    coloured,
    colours_of,
    cramer_rao,
    influence,
    widening,
)
from advisor.oem.estimate import NoEstimate
from advisor.oem.gauss_newton import CONVERGED, OVERFLOW, SINGULAR, Optimum, descend
from advisor.oem.identifiability import LARGEST_ERROR
from advisor.oem.lateral_problem import LateralAssembly, LateralProblem, assemble_lateral
from advisor.oem.lateral_start import lateral_start
from advisor.oem.solution import contributions_of, noise_floor

SIDE_FORCE_STD = 0.05
"""Standard deviation of Y_p and Y_r about zero, 1. C_Yp and C_Yr of 0.4 give 0.01 for a jet of 15 t and 0.04
for an aircraft of 3 kg."""
_PRIOR = np.array([SIDE_FORCE_STD**-2 if name in ("Y_p", "Y_r") else 0.0 for name in LATERAL.names.shared])
_FLY = {"aileron": "an aileron doublet", "rudder": "a rudder doublet"}
_CONTROLS = {"delta_a": "aileron", "delta_r": "rudder"}


@dataclass(frozen=True, slots=True)
class LateralSolution:
    """The optimum of one lateral problem, with its errors."""

    problem: LateralProblem
    assembly: LateralAssembly
    optimum: Optimum
    influence: Influence
    covariance_cr: FloatArray
    """(15, 15) Cramér-Rao bound."""
    covariance: FloatArray
    """(15, 15) covariance corrected for coloured residuals and for the scatter between manoeuvres."""
    noise: Coloured

    @property
    def theta(self) -> FloatArray:
        """(15,) derivatives, in the order of ``LATERAL``."""
        return self.optimum.shared

    @property
    def cost(self) -> float:
        """J = σ_p²·σ_r²."""
        noise = dict(zip(LATERAL.outputs, self.optimum.noise, strict=True))
        return float((noise["p"] * noise["r"]) ** 2)


def solve_lateral(
    problem: LateralProblem, begin: tuple[FloatArray, FloatArray] | None = None
) -> LateralSolution | NoEstimate:
    """Estimate the lateral derivatives of a problem.

    Parameters
    ----------
    begin : shared (15,) and local (m, 9) parameters to start from; by default the regression of
        ``lateral_start``.
    """
    assembly = assemble_lateral(problem)
    shared, local = lateral_start(problem) if begin is None else begin
    data = (assembly.grid, assembly.z, assembly.channel, assembly.owner, assembly.free)
    optimum = descend(*data, noise_floor(assembly), _PRIOR, shared, local)
    if optimum.status == OVERFLOW:
        return NoEstimate(
            "diverged", "The model runs away from its first guess: the record is too long or too noisy."
        )
    if optimum.status == SINGULAR:
        return NoEstimate("singular", "The inputs do not excite roll and yaw enough.")
    if optimum.status != CONVERGED:
        return NoEstimate(
            "not_converged",
            f"The search for the best fit did not converge in {optimum.iterations} iterations:"
            " very different values explain this record equally well.",
        )
    return _evaluated(problem, assembly, optimum)


def _evaluated(
    problem: LateralProblem, assembly: LateralAssembly, optimum: Optimum
) -> LateralSolution | NoEstimate:
    g, residual = optimum.sensitivities, assembly.z - optimum.fitted
    effect = influence(assembly, g, optimum.noise, prior=_PRIOR)
    if effect is None:
        return NoEstimate("singular", "The inputs do not excite roll and yaw enough.")
    free = assembly.free[assembly.free < len(LATERAL.shared)]
    from_prior = (effect.shared_inverse * _PRIOR[free, None]).T @ effect.shared_inverse
    colours = colours_of(assembly, residual, g)
    noise = Coloured(colours, widening(assembly, effect.rows, colours))
    pulls = contributions_of(assembly, effect.rows, residual)
    return LateralSolution(
        problem,
        assembly,
        optimum,
        effect,
        cramer_rao(assembly, effect.rows, optimum.noise) + from_prior,
        widened_by_scatter(coloured(assembly, effect.rows, noise) + from_prior, pulls),
        noise,
    )


def lateral_not_identifiable(solution: LateralSolution) -> dict[str, str]:
    """Return by derivative the reason why it has no usable value, with the input that would tell it."""
    reasons: dict[str, str] = {}
    moved = {name: solution.problem.moves(name) for name in LATERAL.inputs}
    for suffix, name in _CONTROLS.items():
        if not moved[name]:
            text = f"the {name} did not move; fly {_FLY[name]}"
            reasons |= {f"{letter}_{suffix}": text for letter in "YLN"}
    missing = [name for name in LATERAL.inputs if not moved[name]]
    advice = " and ".join(_FLY[name] for name in missing or LATERAL.inputs)
    unresolved = "the record does not depend on it"
    reasons |= {
        name: f"{unresolved}; fly {advice}" for name in solution.influence.unresolved if name not in reasons
    }
    std = np.sqrt(np.diag(solution.covariance))
    for name, size in natural_size(solution.theta).items():
        error = float(std[LATERAL.names.reported.index(name)])
        if name not in reasons and not error <= _largest_error(name) * size:
            reasons[name] = (
                f"its error ±{error:.2g} is too large beside the size of such a derivative here"
                f" ({size:.2g}); fly {advice}"
            )
    return reasons


def _largest_error(name: str) -> float:
    """Return the largest usable error of a derivative, as a share of its natural size.

    A derivative with a prior is told by the data only where its error is clearly below that of the prior.
    """
    return LARGEST_ERROR * SIDE_FORCE_STD if name in ("Y_p", "Y_r") else LARGEST_ERROR


def fits_of(solution: LateralSolution) -> tuple[Mapping[str, tuple[FloatArray, FloatArray]], ...]:
    """Return measured and fitted values (n,) of every manoeuvre and output."""
    assembly = solution.assembly
    return tuple(
        {name: (assembly.z[rows], solution.optimum.fitted[rows]) for name, rows in named.items()}
        for named in assembly.rows
    )
