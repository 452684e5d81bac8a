"""Gauss-Newton over the derivatives, servos and clocks of a lateral problem in one pass.

Every trial lays the records anew at its servos and clocks. All derivatives are analytic, and come from the
pass over the motion that gives the outputs. The steps and the damping are those of ``gauss_newton``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.axis_response import respond_axis
from advisor.model.lateral import LATERAL
from advisor.model.response import Index
from advisor.oem.arrow import arrow_step, normal_equations
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Extra, penalty
from advisor.oem.gauss_newton import (
    CONVERGED,
    DAMPING_FACTOR,
    EXHAUSTED,
    FIRST_DAMPING,
    LEAST_DAMPING,
    MOST_ITERATIONS,
    SINGULAR,
    Optimum,
    weigh,
)
from advisor.oem.lateral_instruments import Nuisance, columns_of, moved_by
from advisor.oem.lateral_problem import CAUSES, LateralAssembly, LateralProblem, assemble_lateral
from advisor.oem.prior import Priors
from advisor.oem.solution import RUNS_AWAY

LEAST_NOISE = {"p": 5e-4, "r": 5e-4, "bank": 5e-4, "a_y": 0.01, "beta": 5e-4}
"""Least standard deviation of each output, SI. Gyros of 0.007 deg/s/√Hz have 5e-4 rad/s at 20 Hz, and the
model itself is no truer: α, θ and V are constant between stamps."""
SETTLED = 1e-3
"""Promised change of -2 log of the posterior at which a search ends. It moves no parameter by more than 0.03
of its standard deviation."""
_SPEED_STEP = 1e-3
"""Numerical: step of the difference by which the outputs' derivative by the air speed is taken."""
_SHARED, _OWN = len(LATERAL.names.shared), len(LATERAL.names.local)
_INITIAL = [LATERAL.names.local.index(f"{state}_initial") for state in LATERAL.states]


class LateralFit(NamedTuple):
    """A lateral problem at one setting of all parameters."""

    problem: LateralProblem
    """Records, with servos and clocks at their values."""
    assembly: LateralAssembly
    optimum: Optimum
    extra: Extra
    """Nuisance parameters at their values."""
    begun: FloatArray
    """(m, 4) rates of the states at the first event of each record. A delay may move that event."""

    @property
    def cost(self) -> float:
        """-2 log of the posterior, up to a constant."""
        return self.optimum.log_likelihood_cost


def outputs_at(problem: LateralProblem, shared: FloatArray, local: FloatArray) -> FloatArray:
    """Return the outputs (N,) of a problem, without their derivatives."""
    assembly = assemble_lateral(problem)
    y = np.empty(len(assembly.z))
    nothing = np.empty((0, _SHARED + _OWN + len(CAUSES)))
    respond_axis(assembly.grid, shared, local, y, nothing, np.empty((0, 2, len(LATERAL.states))))
    return y


class _Setting(NamedTuple):
    """Nuisance parameters and priors of a search."""

    nuisances: Sequence[Nuisance]
    prior: Priors

    def at(
        self, problem: LateralProblem, assembly: LateralAssembly, shared: FloatArray, local: FloatArray
    ) -> LateralFit | None:
        """Return the fit at one setting; None where the model runs away."""
        y = np.empty(len(assembly.z))
        g = np.empty((len(y), _SHARED + _OWN + len(CAUSES)))
        motion = np.empty((len(assembly.grid.step_s), 2, len(LATERAL.states)))
        if not respond_axis(assembly.grid, shared, local, y, g, motion):
            return None
        least = np.array([LEAST_NOISE[name] for name in LATERAL.outputs])
        noise, cost = weigh(assembly.z, y, assembly.channel, least)
        cost += float(np.sum(((assembly.z - y) / noise[assembly.channel]) ** 2))
        cost += float(self.prior.precision @ (shared - self.prior.mean) ** 2) + penalty(
            problem, self.nuisances
        )

        def by_speed() -> FloatArray:
            faster = replace(problem, airspeed_excess=problem.airspeed_excess + _SPEED_STEP)
            return (outputs_at(faster, shared, local) - y) / _SPEED_STEP

        columns = columns_of(assembly, g[:, _SHARED + _OWN :], motion, self.nuisances, by_speed)
        optimum = Optimum(EXHAUSTED, shared, local, noise, cost, 0, y, g[:, : _SHARED + _OWN])
        extra = Extra.of(columns, problem, self.nuisances)
        return LateralFit(problem, assembly, optimum, extra, motion[assembly.grid.first[:-1], 1])

    def step(self, fit: LateralFit, damping: float) -> "_Step | None":
        """Return the damped step from a fit; None where the data do not determine it.

        A nuisance parameter that would leave its range goes to the end of the range, and all others follow.
        """
        system = _System.of(self.prior, fit)
        held: dict[int, float] = {}
        for _ in range(2):
            found = system.solved(damping, held)
            if found is None:
                return None
            wanted = found.shared[_SHARED:]
            moved = moved_by(wanted, fit.problem, self.nuisances)
            allowed = np.array([x.read(moved) - x.read(fit.problem) for x in self.nuisances])
            ends = np.flatnonzero(~np.isclose(allowed, wanted, rtol=1e-6, atol=1e-12))
            if not len(ends):
                break
            held = {int(j): float(allowed[j]) for j in ends}
        return found

    def moved(self, fit: LateralFit, step: "_Step") -> LateralFit | None:
        """Return the fit after a step; None where the model runs away."""
        problem = moved_by(step.shared[_SHARED:], fit.problem, self.nuisances)
        optimum = fit.optimum
        assembly = assemble_lateral(problem)
        local = optimum.local + step.local
        local[:, _INITIAL] += (assembly.begin - fit.assembly.begin)[:, None] * fit.begun
        return self.at(problem, assembly, optimum.shared + step.shared[:_SHARED], local)


class _Step(NamedTuple):
    """A step of all parameters."""

    shared: FloatArray
    """(15 + k,) derivatives, then nuisance parameters."""
    local: FloatArray
    """(m, 9)."""
    promise: float
    """Decrease of -2 log of the posterior that the quadratic model promises."""


class _System(NamedTuple):
    """The normal equations of all parameters; derivatives and nuisance parameters are shared."""

    information: FloatArray
    """(m, n, n)."""
    gradient: FloatArray
    """(m, n)."""
    free: Index
    """(n,) places of the parameters among 15 + k shared and 9 local ones."""
    nuisances: int

    @classmethod
    def of(cls, prior: Priors, fit: LateralFit) -> Self:
        """Return the normal equations at a fit."""
        assembly, optimum, extra = fit.assembly, fit.optimum, fit.extra
        k = len(extra)
        g = np.column_stack(
            [optimum.sensitivities[:, :_SHARED], extra.columns, optimum.sensitivities[:, _SHARED:]]
        )
        free = np.concatenate([assembly.common, _SHARED + np.arange(k), assembly.own + k])
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
        off = np.concatenate([prior.mean - optimum.shared, extra.pull / extra.weight])
        common = free[free < _SHARED + k]
        places = np.arange(len(common))
        information[0, places, places] += weight[common]
        gradient[0, places] += (weight * off)[common]
        return cls(information, gradient, free, k)

    def solved(self, damping: float, held: Mapping[int, float]) -> _Step | None:
        """Return the step with the nuisance parameters ``held`` moved by given amounts, or None."""
        total = _SHARED + self.nuisances
        fixed = np.isin(self.free, [_SHARED + j for j in held])
        amount = np.array([held[int(j) - _SHARED] for j in self.free[fixed]])
        gradient = self.gradient[:, ~fixed] - self.information[:, ~fixed][:, :, fixed] @ amount
        information = np.ascontiguousarray(self.information[:, ~fixed][:, :, ~fixed])
        fine, shared, local, _ = arrow_step(
            information, np.ascontiguousarray(gradient), self.free[~fixed], damping, total, _OWN
        )
        if not fine:
            return None
        for j, move in held.items():
            shared[_SHARED + j] = move
        everything = np.column_stack([np.tile(shared, (len(local), 1)), local])[:, self.free]
        bent = np.einsum("mi,mij,mj->", everything, self.information, everything)
        return _Step(shared, local, float(2.0 * np.sum(everything * self.gradient) - bent))


def fit_lateral(
    problem: LateralProblem,
    nuisances: Sequence[Nuisance],
    prior: Priors,
    begin: tuple[FloatArray, FloatArray],
    most: int = MOST_ITERATIONS,
) -> LateralFit | NoEstimate:
    """Return the fit with the least -2 log of the posterior near a start. Its status says how it was found.

    Parameters
    ----------
    problem
        Records, with servos and clocks at the start of the search.
    nuisances
        Servos and clocks that move with the derivatives.
    prior
        Priors of the derivatives.
    begin
        Derivatives (15,) and local parameters (m, 9).
    most
        Largest number of trials.
    """
    setting = _Setting(nuisances, prior)
    best = setting.at(problem, assemble_lateral(problem), *begin)
    if best is None:
        return RUNS_AWAY
    damping, status, iteration = 0.0, EXHAUSTED, 0
    while status == EXHAUSTED and iteration < most:
        iteration += 1
        step = setting.step(best, damping)
        trial = None if step is None else setting.moved(best, step)
        better = trial is not None and trial.cost <= best.cost
        if trial is not None and better:
            best = trial
        if step is not None and step.promise < SETTLED and (not better or damping <= FIRST_DAMPING):
            status = CONVERGED
        elif better:
            damping = damping / DAMPING_FACTOR if damping > LEAST_DAMPING else 0.0
        elif damping * FIRST_DAMPING > 1.0:
            # Not even a tiny step lowers the cost: only round-off remains.
            status = SINGULAR if step is None else CONVERGED
        else:
            damping = max(FIRST_DAMPING, DAMPING_FACTOR * damping)
    return best._replace(optimum=best.optimum._replace(status=status, iterations=iteration))
