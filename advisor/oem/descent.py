"""Gauss-Newton search over the derivatives, servos and clocks of a problem together, for every axis.

Every trial lays out the records again with its servos and clocks. All derivatives are analytic, and the pass
that simulates the outputs computes them. The steps are those of ``gauss_newton``. The damping follows the
share of the promised decrease that a step brings (Nielsen, *Damping Parameter in Marquardt's Method*, 1999).
Large residuals bend the valley of the cost, in which a damping by powers of ten changes too coarsely.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from advisor.model.axis import Names
from advisor.model.response import Index
from advisor.oem.arrow import arrow_step, normal_equations
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Extra, Parameter, moved_by, penalty
from advisor.oem.gauss_newton import (
    CONVERGED,
    EXHAUSTED,
    FIRST_DAMPING,
    LEAST_DAMPING,
    MOST_ITERATIONS,
    SINGULAR,
    Optimum,
    weigh,
)
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.oem.solution import RUNS_AWAY
from advisor.process.arrays import FloatArray

SETTLED = 1e-3
"""Promised change of -2 log posterior density at which a search ends. A decrease of this size moves no
parameter by more than 0.03 of its standard deviation."""

HALF_WAY = 0.75
"""Numerical: share of the promised decrease below which a damped step goes at least half of the way. Steps
with a greater share may be small by their damping alone."""


class Response(NamedTuple):
    """Simulated outputs with their derivatives, at one setting of all parameters."""

    y: FloatArray
    """(N,)."""
    g: FloatArray
    """Shape (N, s + l): derivatives by the shared parameters and by each manoeuvre's local parameters."""
    columns: Callable[[], FloatArray]
    """Function that returns the derivatives by the nuisance parameters, shape (N, k). A rejected trial step
    needs none."""
    begun: FloatArray
    """Shape (m, states): rates of the states at the first event of each record. A delay may move this first
    event."""


class Motion(Protocol):
    """Interface of an axis' simulated motion for the search. A problem holds records, servos and clocks."""

    @property
    def names(self) -> Names:
        """Names of outputs and parameters."""

    def laid(self, problem: Any, /) -> Laid:
        """Return the measurements as stacked rows."""

    def floor(self, laid: Any, /) -> FloatArray:
        """Return the least standard deviation of each output, shape (outputs,), SI."""

    def respond(
        self, problem: Any, laid: Any, shared: FloatArray, local: FloatArray, nuisances: Sequence[Any], /
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""

    def begins(self, laid: Any, /) -> FloatArray:
        """Return the time of the first event of each record, shape (m,), s."""


@dataclass(frozen=True, slots=True)
class Fit:
    """A problem with one setting of all parameters, and its residuals."""

    problem: Any
    """Records with the present values of servos and clocks."""
    assembly: Any
    optimum: Optimum
    nuisances: Sequence[Parameter]
    response: Response

    @property
    def extra(self) -> Extra:
        """Nuisance parameters at their present values."""
        return Extra.of(self.response.columns(), self.problem, self.nuisances)

    @property
    def cost(self) -> float:
        """-2 log posterior density, up to a constant."""
        return self.optimum.log_likelihood_cost

    @property
    def place(self) -> tuple[FloatArray, FloatArray]:
        """Derivatives and local parameters, as the start of another search."""
        return self.optimum.shared, self.optimum.local


class _Setting(NamedTuple):
    """Motion, nuisance parameters and priors of a search."""

    motion: Motion
    nuisances: Sequence[Parameter]
    prior: Priors

    def at(self, problem: Any, assembly: Laid, shared: FloatArray, local: FloatArray) -> Fit | None:
        """Return the fit at one setting; None if the simulation diverges."""
        response = self.motion.respond(problem, assembly, shared, local, self.nuisances)
        if response is None:
            return None
        y = response.y
        noise, cost = weigh(assembly.z, y, assembly.channel, self.motion.floor(assembly))
        cost += float(np.sum(((assembly.z - y) / noise[assembly.channel]) ** 2))
        cost += float(self.prior.precision @ (shared - self.prior.mean) ** 2)
        cost += penalty(problem, self.nuisances)
        optimum = Optimum(EXHAUSTED, shared, local, noise, cost, 0, y, response.g)
        response = response._replace(columns=cache(response.columns))
        return Fit(problem, assembly, optimum, self.nuisances, response)

    def step(self, fit: Fit, damping: float) -> "_Step | None":
        """Return the damped step from a fit; None if the data do not determine the step.

        A nuisance parameter that would leave its range is fixed at the range's end, and the others are solved
        again.
        """
        system = _System.of(self.prior, fit)
        held: dict[int, float] = {}
        for _ in range(len(self.nuisances) + 1):
            solved = system.solved(damping, held)
            if solved is None:
                return None
            wanted = solved.shared[len(fit.optimum.shared) :]
            moved = moved_by(wanted, fit.problem, self.nuisances)
            allowed = np.array([x.read(moved) - x.read(fit.problem) for x in self.nuisances])
            ends = np.flatnonzero(~np.isclose(allowed, wanted, rtol=1e-6, atol=1e-12))
            if not len(ends):
                break
            held |= {int(j): float(allowed[j]) for j in ends}
        return solved

    def moved(self, fit: Fit, step: "_Step") -> Fit | None:
        """Return the fit after a step; None if the simulation diverges."""
        optimum, count = fit.optimum, len(fit.optimum.shared)
        problem, assembly = fit.problem, fit.assembly
        if self.nuisances:
            problem = moved_by(step.shared[count:], problem, self.nuisances)
            assembly = self.motion.laid(problem)
        local = optimum.local + step.local
        later = self.motion.begins(assembly) - self.motion.begins(fit.assembly)
        begun = fit.response.begun
        local[:, _initial(self.motion.names, begun.shape[1])] += later[:, None] * begun
        return self.at(problem, assembly, optimum.shared + step.shared[:count], local)


def _initial(names: Names, states: int) -> list[int]:
    """Return the indices of the initial states among the local parameters."""
    return [j for j, name in enumerate(names.local) if name.endswith("_initial")][:states]


class _Step(NamedTuple):
    """A step of all parameters."""

    shared: FloatArray
    """Shape (s + k,): steps of the derivatives, then of the nuisance parameters."""
    local: FloatArray
    """Shape (m, l): steps of the local parameters."""
    promise: float
    """Decrease of -2 log posterior density that the quadratic model promises."""


class _System(NamedTuple):
    """The normal equations of all parameters; derivatives and nuisance parameters are shared."""

    information: FloatArray
    """Shape (m, n, n): information matrix of each manoeuvre."""
    gradient: FloatArray
    """Shape (m, n): gradient of each manoeuvre."""
    free: Index
    """Shape (n,): indices of the free parameters among s + k shared and l local parameters."""
    shared: int
    """s."""
    own: int
    """l."""
    nuisances: int

    @classmethod
    def of(cls, prior: Priors, fit: Fit) -> Self:
        """Return the normal equations at a fit."""
        assembly, optimum, extra = fit.assembly, fit.optimum, fit.extra
        k, s = len(extra), len(optimum.shared)
        g = np.column_stack([optimum.sensitivities[:, :s], extra.columns, optimum.sensitivities[:, s:]])
        free = np.concatenate([assembly.common, s + np.arange(k), assembly.own + k])
        information, gradient = normal_equations(
            assembly.maneuvers,
            assembly.z - optimum.fitted,
            g,
            assembly.channel,
            assembly.owner,
            free,
            optimum.noise,
        )
        information = information + np.transpose(np.tril(information, -1), (0, 2, 1))
        weight = np.concatenate([prior.precision, (extra.weight / extra.share) ** 2])
        weight_or_one = np.where(extra.weight > 0.0, extra.weight, 1.0)
        off = np.concatenate([prior.mean - optimum.shared, extra.pull / weight_or_one])
        common = free[free < s + k]
        places = np.arange(len(common))
        information[0, places, places] += weight[common]
        gradient[0, places] += (weight * off)[common]
        return cls(information, gradient, free, s, optimum.local.shape[1], k)

    def solved(self, damping: float, held: Mapping[int, float]) -> _Step | None:
        """Return the step with the nuisance parameters in ``held`` moved by given amounts; None if
        undetermined."""
        total = self.shared + self.nuisances
        fixed = np.isin(self.free, [self.shared + j for j in held])
        amount = np.array([held[int(j) - self.shared] for j in self.free[fixed]])
        gradient = self.gradient[:, ~fixed] - self.information[:, ~fixed][:, :, fixed] @ amount
        information = np.ascontiguousarray(self.information[:, ~fixed][:, :, ~fixed])
        fine, shared, local, _ = arrow_step(
            information, np.ascontiguousarray(gradient), self.free[~fixed], damping, total, self.own
        )
        if not fine:
            return None
        for j, move in held.items():
            shared[self.shared + j] = move
        everything = np.column_stack([np.tile(shared, (len(local), 1)), local])[:, self.free]
        bent = np.einsum("mi,mij,mj->", everything, self.information, everything)
        return _Step(shared, local, float(2.0 * np.sum(everything * self.gradient) - bent))


def descended(
    motion: Motion,
    problem: Any,
    nuisances: Sequence[Parameter],
    prior: Priors,
    begin: tuple[FloatArray, FloatArray],
    most: int = MOST_ITERATIONS,
    settled: float = SETTLED,
) -> Fit | NoEstimate:
    """Return the fit with the least -2 log posterior density near a start. The status of the fit states how
    the search ended.

    Parameters
    ----------
    problem
        Records, with servos and clocks at the start of the search.
    nuisances
        Servos and clocks that are estimated with the derivatives.
    prior
        Priors of the derivatives.
    begin
        Derivatives (s,) and local parameters (m, l).
    most
        Largest number of trial steps.
    settled
        Promised decrease of -2 log posterior density at which the search ends.
    """
    setting = _Setting(motion, nuisances, prior)
    best = setting.at(problem, motion.laid(problem), *begin)
    if best is None:
        return RUNS_AWAY
    damping, growth, status, iteration = 0.0, 2.0, EXHAUSTED, 0
    while status == EXHAUSTED and iteration < most:
        iteration += 1
        step = setting.step(best, damping)
        trial = None if step is None else setting.moved(best, step)
        better = trial is not None and trial.cost <= best.cost
        brought = 0.0
        if trial is not None and step is not None and better:
            brought, best = min(1.0, (best.cost - trial.cost) / max(step.promise, 1e-300)), trial
        if step is not None and step.promise < settled and (brought < HALF_WAY or damping <= FIRST_DAMPING):
            status = CONVERGED
        elif better:
            damping *= max(1.0 / 3.0, 1.0 - (2.0 * brought - 1.0) ** 3)
            damping, growth = damping if damping > LEAST_DAMPING else 0.0, 2.0
        elif damping * FIRST_DAMPING > 1.0:
            # Not even a tiny step lowers the cost: only round-off remains.
            status = SINGULAR if step is None else CONVERGED
        else:
            damping, growth = max(FIRST_DAMPING, growth * damping), 2.0 * growth
    return replace(best, optimum=best.optimum._replace(status=status, iterations=iteration))
