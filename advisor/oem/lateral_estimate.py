"""Output error on the lateral axis: from records to derivatives, errors and identifiability.

The search, the influence of every measurement and the noise model are those of the short period. Y_p and Y_r
have priors: Y_p = ρ·S·b·C_Yp/(4·m), and likewise Y_r, are a few per cent on every aircraft. So do the
derivatives of a control that hardly moves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

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
from advisor.oem.extra import Extra
from advisor.oem.gauss_newton import CONVERGED, FLAT, Optimum, descend
from advisor.oem.identifiability import LARGEST_ERROR
from advisor.oem.lateral_instruments import Nuisance, begun, extra_of, moved_by, penalty
from advisor.oem.lateral_problem import LateralAssembly, LateralProblem, assemble_lateral
from advisor.oem.lateral_start import lateral_start
from advisor.oem.solution import contributions_of, noise_floor, refused
from advisor.words.quantiles import NORMAL_95

SIDE_FORCE_STD = 0.05
"""Standard deviation of Y_p and Y_r about zero, 1. C_Yp and C_Yr of 0.4 give 0.01 for a jet of 15 t and 0.04
for an aircraft of 3 kg."""
LEAST_NOISE = {"p": 5e-4, "r": 5e-4, "bank": 5e-4, "a_y": 0.01, "beta": 5e-4}
"""Least standard deviation of each output, SI. Gyros of 0.007 deg/s/√Hz have 5e-4 rad/s at 20 Hz, and the
model itself is no truer: α, θ and V are constant between stamps."""
ROUNDS = 8
SETTLED = 1e-2
"""Change of -2 log likelihood, per round, below which the search for nuisance parameters is done."""
CLOSE_ENOUGH = 1e-7
"""Promised change of log J per sample at which an intermediate search ends."""
LEAST_SHARE = 0.01
"""Least share by which white noise weighs a prior; data without noise have no colour."""
_NOTHING_TO_TELL = "The inputs do not excite roll and yaw enough."
WITHOUT_FORCE = (
    "neither a lateral acceleration nor a sideslip was recorded, so that only the modes are told; record a_y"
)
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
    joint: FloatArray
    """(15 + k, 15 + k) covariance of derivatives and of k nuisance parameters. It is corrected for coloured
    residuals and for the scatter between manoeuvres."""
    extra: Extra
    """Nuisance parameters at their values."""
    noise: Coloured
    nuisances: Mapping[str, tuple[float, float]]
    """Name of each nuisance parameter to its value and standard deviation, in its unit."""

    @property
    def theta(self) -> FloatArray:
        """(15,) derivatives, in the order of ``LATERAL``."""
        return self.optimum.shared

    @property
    def covariance(self) -> FloatArray:
        """(15, 15) covariance of the derivatives."""
        return self.joint[: len(self.theta), : len(self.theta)]

    @property
    def cost(self) -> float:
        """J = σ_p²·σ_r²."""
        noise = dict(zip(LATERAL.outputs, self.optimum.noise, strict=True))
        return float((noise["p"] * noise["r"]) ** 2)


class _Fit(NamedTuple):
    """The optimum at one setting of the nuisance parameters."""

    problem: LateralProblem
    assembly: LateralAssembly
    optimum: Optimum
    prior: FloatArray
    """(15,) inverse variance of each derivative about zero before the flight; 0 without a prior."""

    def cost(self, nuisances: Sequence[Nuisance]) -> float:
        """Return -2 log of the posterior up to a constant."""
        return self.optimum.log_likelihood_cost + penalty(self.problem, nuisances)


def solve_lateral(
    problem: LateralProblem, nuisances: Sequence[Nuisance] = ()
) -> LateralSolution | NoEstimate:
    """Estimate the lateral derivatives of a problem.

    Parameters
    ----------
    nuisances : servos and clocks that are estimated with the derivatives.
    """
    first = begun(problem, nuisances)
    start = lateral_start(first)
    fit = _at(first, start, _prior(first, start[0]))
    if (why := refused(fit.optimum, _NOTHING_TO_TELL)) is not None:
        return why
    plain = _evaluated(fit, ())
    if isinstance(plain, NoEstimate) or not nuisances:
        return plain
    ratio = np.diag(plain.covariance_cr) / np.where(
        np.diag(plain.covariance) > 0.0, np.diag(plain.covariance), np.nan
    )
    share = float(np.clip(np.sqrt(np.nanmedian(ratio)), LEAST_SHARE, 1.0))
    weighed = [replace(x, prior=replace(x.prior, share=share)) for x in nuisances]
    return _evaluated(_descended(fit, weighed), weighed)


def _prior(problem: LateralProblem, start: FloatArray) -> FloatArray:
    """Return the inverse variance of each derivative before the flight, shape (15,), given a start (15,).

    A control that hardly moves would otherwise explain any error of the model. Its derivatives scatter about
    zero by those of the control that is flown.
    """
    size = dict.fromkeys(LATERAL.names.shared, 0.0)
    size |= {"Y_p": SIDE_FORCE_STD, "Y_r": SIDE_FORCE_STD}
    power = natural_size(start)
    flown = [suffix for suffix, name in _CONTROLS.items() if problem.flies(name)]
    for suffix in _CONTROLS.keys() - flown:
        for letter in "YLN":
            size[f"{letter}_{suffix}"] = max((power[f"{letter}_{other}"] for other in flown), default=0.0)
    return np.array([std**-2 if std > 0.0 else 0.0 for std in size.values()])


def _at(
    problem: LateralProblem, begin: tuple[FloatArray, FloatArray], prior: FloatArray, flat: float = FLAT
) -> _Fit:
    assembly = assemble_lateral(problem)
    data = (assembly.grid, assembly.z, assembly.channel, assembly.owner, assembly.free)
    return _Fit(problem, assembly, descend(*data, _floor(assembly), prior, *begin, flat), prior)


def _floor(assembly: LateralAssembly) -> FloatArray:
    least = np.array([LEAST_NOISE[name] for name in LATERAL.outputs])
    return np.asarray(np.maximum(noise_floor(assembly), least))


def _descended(begin: _Fit, nuisances: Sequence[Nuisance]) -> _Fit:
    """Minimise the cost over the nuisance parameters, with everything else refitted at each step."""
    best = begin
    for _ in range(ROUNDS):
        optimum = best.optimum
        extra = extra_of(best.problem, optimum.shared, optimum.local, nuisances)
        effect = influence(best.assembly, optimum.sensitivities, optimum.noise, extra, best.prior)
        if effect is None:
            break
        step = effect.step(best.assembly.z - optimum.fitted, extra)[len(LATERAL.shared) :]
        found = None
        for _ in range(4):
            moved = moved_by(step, best.problem, nuisances)
            trial = _at(moved, (optimum.shared, optimum.local), best.prior, CLOSE_ENOUGH)
            if trial.optimum.status == CONVERGED and trial.cost(nuisances) < best.cost(nuisances):
                found = trial
                break
            step = step / 4.0
        if found is None:
            break
        gain, best = best.cost(nuisances) - found.cost(nuisances), found
        if gain < SETTLED:
            break
    return best


def _evaluated(fit: _Fit, nuisances: Sequence[Nuisance]) -> LateralSolution | NoEstimate:
    problem, assembly, optimum, prior = fit
    g, residual = optimum.sensitivities, assembly.z - optimum.fitted
    extra = extra_of(problem, optimum.shared, optimum.local, nuisances)
    effect = influence(assembly, g, optimum.noise, extra, prior)
    if effect is None:
        return NoEstimate("singular", _NOTHING_TO_TELL)
    free = assembly.free[assembly.free < len(LATERAL.shared)]
    from_priors = (effect.shared_inverse * prior[free, None]).T @ effect.shared_inverse
    from_priors = from_priors + effect.prior_covariance
    colours = colours_of(assembly, residual, g)
    noise = Coloured(colours, widening(assembly, effect.rows, colours))
    pulls = contributions_of(assembly, effect.rows, residual)
    bound = cramer_rao(assembly, effect.rows, optimum.noise) + from_priors
    told = widened_by_scatter(coloured(assembly, effect.rows, noise) + from_priors, pulls)
    n = len(LATERAL.shared)
    joint = _at_least(bound, told)
    std = np.sqrt(np.diag(joint))
    return LateralSolution(
        problem,
        assembly,
        optimum,
        effect,
        bound[:n, :n],
        joint,
        extra,
        noise,
        {x.name: (x.read(problem), float(std[n + k])) for k, x in enumerate(nuisances)},
    )


def _at_least(bound: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the covariance with no error below that of ``bound``: instruments are no better than
    ``LEAST_NOISE``."""
    stated = np.diag(covariance)
    ratio = np.divide(np.diag(bound), stated, out=np.ones_like(stated), where=stated > 0.0)
    factor = np.sqrt(np.maximum(ratio, 1.0))
    return np.asarray(covariance * np.outer(factor, factor))


def lateral_not_identifiable(solution: LateralSolution) -> dict[str, str]:
    """Return by derivative the reason why it has no usable value, with the input that would tell it."""
    if not any({"a_y", "beta"} & record.outputs.keys() for record in solution.problem.records):
        return dict.fromkeys(LATERAL.names.reported, WITHOUT_FORCE)
    reasons: dict[str, str] = {}
    problem = solution.problem
    missing = [name for name in LATERAL.inputs if not problem.flies(name)]
    for suffix, name in _CONTROLS.items():
        if name in missing:
            moved = f"moved by {np.degrees(problem.motion(name)):.1f} deg only"
            text = f"the {name} {moved if problem.moves(name) else 'did not move'}; fly {_FLY[name]}"
            reasons |= {f"{letter}_{suffix}": text for letter in "YLN"}
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
                f"its error ±{NORMAL_95 * error:.2g} is too large for the size of such a derivative"
                f" here ({size:.2g}); fly {advice}"
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
