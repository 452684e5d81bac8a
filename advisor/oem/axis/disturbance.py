"""Response of all outputs of an axis to a disturbance in one block of the simulator.

A disturbance is added to a control's deflection, to one equation, to the air or to one sensor. A gust adds
its angle to the incidence that wing, fin and vane meet, so it enters force and moments together. A
disturbance is linear between knots.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from advisor.model.axis import Axis
from advisor.model.axis import Linear as Motion
from advisor.oem.arrow import unabsorbed
from advisor.oem.axis.problem import AxisAssembly, AxisProblem
from advisor.oem.turbulence import KNOTS_S
from advisor.process.arrays import FloatArray

AIR = "air"
STEP_S = 0.02
"""Time step of the simulated response to a disturbance, s: a fifth of the distance of the knots."""


class Linear(NamedTuple):
    """A fit whose outputs change linearly with a disturbance."""

    problem: AxisProblem
    assembly: AxisAssembly
    theta: FloatArray
    """(s,)"""
    sensitivities: FloatArray
    """Shape (N, s + l): derivatives of the outputs by the derivatives and the local parameters."""
    noise: FloatArray
    """Shape (outputs,): standard deviation of each output's noise, SI."""

    @property
    def weight(self) -> FloatArray:
        """Shape (N,): inverse standard deviation of each row's noise."""
        return np.asarray(1.0 / self.noise[self.assembly.channel])

    def unabsorbed(self, m: int, columns: FloatArray) -> FloatArray:
        """Return the part of ``columns`` (n, k) that no trim or initial state of manoeuvre ``m`` absorbs."""
        rows = self.assembly.blocks[m]
        return unabsorbed(columns, self.sensitivities[rows][:, self.assembly.own], self.weight[rows])


class Course(NamedTuple):
    """Response of one manoeuvre to a disturbance."""

    knots: FloatArray
    """Shape (k,): times of the disturbance's knots, s."""
    columns: FloatArray
    """Shape (n, k): change of the outputs per unit disturbance at each knot, without the part that trims and
    initial states absorb.
    """


def blocks_of(fit: Linear) -> Iterator[str]:
    """Yield the blocks whose disturbance these records can show."""
    axis = fit.problem.axis
    yield from (axis.blocks.get(name, name) for name in axis.inputs if fit.problem.flies(name))
    yield from axis.equations
    if axis.hidden:  # a gust adds its angle to that state
        yield AIR
    there = {axis.outputs[k] for k in np.unique(fit.assembly.channel)}
    yield from (block for block, output in axis.sensors.items() if output in there)


def courses_of(fit: Linear, block: str = AIR) -> tuple[Course, ...]:
    """Return the response of every manoeuvre to a disturbance in a block, from the derivatives of a fit.

    The disturbance's unit is rad at a control and in the air, 1/s or rad/s² in an equation.
    """
    return tuple(_course(fit, m, block) for m in range(fit.assembly.maneuvers))


def _course(fit: Linear, m: int, block: str) -> Course:
    stamps = fit.assembly.t[fit.assembly.blocks[m]]
    knots = np.arange(np.min(stamps), np.max(stamps) + KNOTS_S, KNOTS_S)
    t = np.arange(knots[0], knots[-1] + STEP_S, STEP_S)
    # Speed and trim are constant: every knot but the first changes the outputs like the second one, later.
    hats = np.maximum(0.0, 1.0 - np.abs(t[:, None] - knots[:2]) / KNOTS_S)  # weights of the linear course
    begun = _outputs(fit, m, block, hats)
    seen = {name: _later(two, len(knots)) for name, two in begun.items()}
    return Course(knots, fit.unabsorbed(m, _read(fit, m, t, seen)))


def _later(two: FloatArray, knots: int) -> FloatArray:
    """Return the responses (n, knots) to a disturbance at every knot, from those at the first two knots (n,
    2)."""
    step = round(KNOTS_S / STEP_S)
    changes = np.zeros((len(two), knots))
    changes[:, 0] = two[:, 0]
    for k in range(1, knots):
        late = (k - 1) * step
        changes[late:, k] = two[: len(two) - late, 1]
    return changes


def answered(fit: Linear, m: int, block: str, t: FloatArray, course: FloatArray) -> FloatArray:
    """Return the response (n, k) of one manoeuvre's outputs to ``k`` disturbances in a block."""
    return _read(fit, m, t, _outputs(fit, m, block, course))


def _read(fit: Linear, m: int, t: FloatArray, seen: Mapping[str, FloatArray]) -> FloatArray:
    """Return the changes (n, k) of outputs, interpolated from the times ``t`` to the stamps of a
    manoeuvre.
    """
    parts = []
    for name, rows in fit.assembly.rows[m].items():
        change = seen.get(name, np.zeros((len(t), next(iter(seen.values())).shape[1])))
        at = (fit.assembly.t[rows] - t[0]) / STEP_S
        k = np.clip(at.astype(int), 0, len(t) - 2)
        share = (at - k)[:, None]
        parts.append((1.0 - share) * change[k] + share * change[k + 1])
    return np.concatenate(parts)


def _outputs(fit: Linear, m: int, block: str, course: FloatArray) -> Mapping[str, FloatArray]:
    """Return the change (n, k) of each output by disturbances (n, k), by the output's name."""
    axis = fit.problem.axis
    if block in axis.sensors:
        return {axis.sensors[block]: course}
    linear, n, k = fit.problem.linear(fit.theta, m, true=False), len(axis.states), course.shape[1]
    # What a disturbance adds to the parameters' part of the rates is seen by the outputs of rates as well.
    drives = _drives(axis, block, linear)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = linear.matrix, drives, 1.0 / STEP_S
    step = expm(STEP_S * whole)
    x = np.zeros((len(course), n, k))
    x[1:] = step[:n, n, None] * course[:-1, None] + step[:n, n + 1, None] * np.diff(course, axis=0)[:, None]
    for i in range(len(course) - 1):
        x[i + 1] += step[:n, :n] @ x[i]
    seen = np.einsum("os,nsk->onk", linear.seen, x)
    seen += (linear.seen_rates @ drives)[:, None, None] * course
    if block == AIR and not fit.problem.is_computed:  # a vane sees the gust itself
        seen[axis.outputs.index(axis.hidden)] += course
    return dict(zip(axis.outputs, seen, strict=True))


def _drives(axis: Axis, block: str, linear: Motion) -> FloatArray:
    """Return the coefficient of a block's disturbance in each state equation, shape (n,)."""
    if block in axis.equations:
        return np.array([float(state == axis.equations[block]) for state in axis.states])
    columns = (*axis.states, *axis.inputs)
    control = {block: name for name, block in axis.blocks.items()}.get(block, block)
    return np.asarray(linear.aerodynamic[:, columns.index(axis.hidden if block == AIR else control)])
