"""Simulated motion of roll and yaw, for the search over derivatives, servos and clocks."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.model.axes.lateral import LATERAL, Trim, state_matrix
from advisor.model.axis_response import respond_axis
from advisor.oem.axes.lateral.instruments import Nuisance, columns_of
from advisor.oem.axes.lateral.problem import (
    ALL,
    CAUSES,
    OPEN,
    LateralAssembly,
    LateralProblem,
    assemble_lateral,
)
from advisor.oem.descent import Response
from advisor.oem.driven_motion.linear import Linear
from advisor.oem.instrument_columns import STEP
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray

LEAST_NOISE = {"p": 5e-4, "r": 5e-4, "bank": 5e-4, "a_y": 0.01, "beta": 5e-4}
"""Least standard deviation of each output, SI. Gyros of 0.007 deg/s/√Hz have 5e-4 rad/s at 20 Hz, and the
model's errors are as large."""
FORCED = "beta", "p", "r"
"""States whose rates contain a force or a moment."""
FLOOR = np.array([LEAST_NOISE[name] for name in LATERAL.outputs])


class LateralMotion:
    """Simulated response of roll and yaw, with the derivatives by all parameters."""

    names = LATERAL.names

    @staticmethod
    def laid(problem: LateralProblem, /) -> LateralAssembly:
        """Return the measurements as stacked rows."""
        return assemble_lateral(problem)

    @staticmethod
    def floor(_: LateralAssembly, /) -> FloatArray:
        """Return the least standard deviation of each output, shape (5,), SI."""
        return FLOOR

    @staticmethod
    def begins(laid: LateralAssembly, /) -> FloatArray:
        """Return the time of the first event of each record, shape (m,), s."""
        return laid.begin

    @staticmethod
    def linear(problem: LateralProblem, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` at its mean air speed and trim."""
        record = problem.records[m]
        speed = float(np.mean(record.airspeed.y))
        ratio = speed / (problem.reference_airspeed_m_s or speed)
        scaled = shared * np.array([ratio**term.power for term in LATERAL.shared])
        true = (1.0 + problem.airspeed_excess) * speed
        trim = Trim(true, float(np.mean(record.alpha.y)), float(np.mean(record.theta.y)))
        matrix = state_matrix(scaled, trim)
        aerodynamic = matrix - state_matrix(np.zeros(len(shared)), trim)
        seen = np.zeros((len(LATERAL.outputs), len(LATERAL.states)))
        for row, column in (("p", "p"), ("r", "r"), ("bank", "bank"), ("beta", "beta")):
            seen[LATERAL.outputs.index(row), LATERAL.states.index(column)] = 1.0
        beta, yaw = LATERAL.states.index("beta"), LATERAL.states.index("r")
        vane, force = LATERAL.outputs.index("beta"), LATERAL.outputs.index("a_y")
        seen[vane, yaw] = problem.beta_arm_m / true
        seen[force] = true * aerodynamic[beta] + problem.accelerometer_arm_m * aerodynamic[yaw]
        air_seen = np.zeros(len(LATERAL.outputs))
        air_seen[vane], air_seen[force] = 1.0, seen[force, beta]
        forced = np.array([LATERAL.states.index(name) for name in FORCED])
        return Linear(matrix, seen, aerodynamic[:, beta], air_seen, forced)

    @staticmethod
    def unsure(_: LateralAssembly, y: FloatArray, /) -> FloatArray:
        """Return no change of the outputs: the fit estimates every instrument, shape (N, 0)."""
        return np.empty((len(y), 0))

    @staticmethod
    def respond(
        problem: LateralProblem,
        laid: LateralAssembly,
        shared: FloatArray,
        local: FloatArray,
        nuisances: Sequence[Nuisance],
        /,
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""
        simulated = simulate(laid, shared, local)
        if simulated is None:
            return None
        y, g, motion = simulated

        def by_term(term: str) -> FloatArray:
            alone = replace(problem, terms={**dict.fromkeys(problem.terms, 0.0), term: 1.0})
            forced = assemble_lateral(alone, ()).grid.forced
            step = STEP / max(float(np.max(np.abs(forced))), 1e-300)
            ends = [laid.grid._replace(forced=laid.grid.forced + by * forced) for by in (step, -step)]
            up, down = (outputs_of(replace(laid, grid=end), shared, local) for end in ends)
            return (up - down) / (2.0 * step)

        def columns() -> FloatArray:
            by = dict(zip((*OPEN, *CAUSES), g[:, ALL:].T, strict=True))
            by["airspeed_excess"] = by["airspeed_excess"] / (1.0 + problem.airspeed_excess)
            by |= {term: by_term(term) for term in problem.terms}
            return columns_of(laid, by, motion, nuisances, y)

        return Response(y, g[:, :ALL], columns, motion[laid.grid.first[:-1], 1])


def simulate(laid: LateralAssembly, shared: FloatArray, local: FloatArray) -> tuple[FloatArray, ...] | None:
    """Return the simulated outputs (N,), their derivatives (N, w) by all parameters, open numbers and causes,
    and the motion (E, 2, 4) of ``respond_axis``; None where the simulation diverges."""
    y, width = np.empty(len(laid.z)), ALL + len(OPEN) + laid.grid.changed.shape[1]
    g = np.empty((len(y), width))
    motion = np.empty((len(laid.grid.step_s), 2, len(LATERAL.states)))
    return (y, g, motion) if respond_axis(laid.grid, shared, local, y, g, motion) else None


def outputs_of(laid: LateralAssembly, shared: FloatArray, local: FloatArray) -> FloatArray:
    """Return the simulated outputs (N,) without their derivatives."""
    y = np.empty(len(laid.z))
    respond_axis(laid.grid, shared, local, y, np.empty((0, ALL)), np.empty((0, 2, len(LATERAL.states))))
    return y


def with_sideslip(problem: LateralProblem, fit: Solution) -> LateralProblem:
    """Return the problem with the sideslip of a fit's model as a signal of every record."""
    laid = fit.assembly
    made = simulate(laid, fit.optimum.shared, fit.optimum.local)
    if made is None:
        return problem
    grid, records = laid.grid, []
    for m, record in enumerate(problem.records):
        events = slice(grid.first[m], grid.first[m + 1])
        t = laid.begin[m] + np.concatenate([[0.0], np.cumsum(grid.step_s[events][:-1])])
        sideslip = Signal(t, made[2][events, 0, LATERAL.states.index("beta")])
        records.append(replace(record, signals={**record.signals, "beta": sideslip}))
    return replace(problem, records=tuple(records))
