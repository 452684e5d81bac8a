"""Simulated motion of an axis, for the search over derivatives, servos and clocks."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.model.axis import CONSTANT, Axis, Names, Place
from advisor.model.axis_response import respond_axis
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import TERM, AxisAssembly, AxisProblem, causes_of, lay_out
from advisor.oem.descent import Response
from advisor.oem.driven_motion.setting import Linear
from advisor.oem.instrument_columns import STEP
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class AxisMotion:
    """Simulated response of an axis, with the derivatives by all parameters."""

    axis: Axis

    @property
    def names(self) -> Names:
        """Names of outputs and parameters."""
        return self.axis.names

    def laid(self, problem: AxisProblem, /) -> AxisAssembly:
        """Return the measurements as stacked rows."""
        return lay_out(problem, causes_of(self.axis))

    def floor(self, laid: AxisAssembly, /) -> FloatArray:
        """Return the least standard deviation of each output, shape (outputs,), SI."""
        return laid.least

    def begins(self, laid: AxisAssembly, /) -> FloatArray:
        """Return the time of the first event of each record, shape (m,), s."""
        return laid.begin

    def linear(self, problem: AxisProblem, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` at its mean air speed and trim."""
        axis, linear = self.axis, problem.linear(shared, m)
        gust, air_seen = np.zeros(len(axis.states)), np.zeros(len(axis.outputs))
        if axis.hidden:
            # A vane sees the gust itself, and forces see it through the motion's equations.
            gust = linear.aerodynamic[:, axis.states.index(axis.hidden)]
            air_seen = linear.seen_rates @ gust
            air_seen[axis.outputs.index(axis.hidden)] += not problem.is_computed
        forced = np.array([axis.states.index(state) for state in axis.letters.values()])
        return Linear(linear.matrix, linear.seen, gust, air_seen, forced)

    def unsure(self, _: AxisAssembly, y: FloatArray, /) -> FloatArray:
        """Return no change of the outputs: the fit estimates every instrument, shape (N, 0)."""
        return np.empty((len(y), 0))

    def respond(
        self,
        problem: AxisProblem,
        laid: AxisAssembly,
        shared: FloatArray,
        local: FloatArray,
        parameters: Sequence[Parameter],
        /,
    ) -> Response | None:
        """Return the response of the model; None if the simulation diverges."""
        simulated = simulate(laid, shared, local)
        if simulated is None:
            return None
        y, g, motion = simulated

        def column(x: Parameter) -> FloatArray:
            if x.place[0] == TERM or x.place in self.axis.moments:
                return _by_force(x.place, problem, laid, (shared, local))
            made = column_of(x.place, problem.at(x.place), laid, local, simulated)
            return _late(x.place[0], laid, y) if made is None else made

        def columns() -> FloatArray:
            return np.array([column(x) for x in parameters]).reshape(-1, len(y)).T

        count = self.axis.count
        return Response(y, g[:, :count], columns, motion[laid.grid.first[:-1], 1])


Simulated = tuple[FloatArray, FloatArray, FloatArray]
"""Outputs (N,), their derivatives (N, w) by all parameters, open numbers and causes, and the motion (E, 2, n)
of ``respond_axis``."""


def simulate(laid: AxisAssembly, shared: FloatArray, local: FloatArray) -> Simulated | None:
    """Return the simulated outputs, their derivatives and the motion; None where the simulation diverges."""
    axis, grid = laid.axis, laid.grid
    y = np.empty(len(laid.z))
    g = np.empty((len(y), axis.count + len(axis.open) + len(laid.causes)))
    motion = np.empty((len(grid.step_s), 2, len(axis.states)))
    return (y, g, motion) if respond_axis(grid, shared, local, y, g, motion) else None


def outputs_of(laid: AxisAssembly, shared: FloatArray, local: FloatArray) -> FloatArray:
    """Return the simulated outputs (N,) without their derivatives."""
    y, no_rates = np.empty(len(laid.z)), np.empty((0, 2, len(laid.axis.states)))
    respond_axis(laid.grid, shared, local, y, np.empty((0, laid.axis.count)), no_rates)
    return y


def column_of(
    place: Place, value: float, laid: AxisAssembly, local: FloatArray, simulated: Simulated
) -> FloatArray | None:
    """Return the outputs' derivative (N,) by the value at a place; None if the simulation lacks it."""
    axis, (y, g, motion), grid = laid.axis, simulated, laid.grid
    of, entry = place
    if place in axis.open:
        column = g[:, axis.count + axis.open.index(place)]
        # The kernel's number is the logarithm of the true over the read air speed.
        return column / (1.0 + value) if entry == "excess" else column
    if place in laid.causes:
        return np.asarray(g[:, axis.count + len(axis.open) + laid.causes.index(place)])
    if of not in axis.outputs or entry not in ("delay_s", "scale", "arm_m"):
        return None
    column, output = np.zeros(len(y)), axis.outputs.index(of)
    rows = laid.channel == output
    if entry == "scale":
        bias = axis.bias[output] - len(axis.shared)
        shift = local[laid.owner[rows], bias] if bias >= 0 else 0.0
        column[rows] = (y[rows] - shift) / grid.scale[output]
        return column
    number, sign, order = (None, -1.0, 1) if entry == "delay_s" else (place, 1.0, 0)
    terms = [read for read in axis.seen if read.output == of and read.number == number]
    if not terms or any(read.of_rate for read in terms):
        return None  # the rates have no rates of their own
    row = grid.row[output]
    events, row = np.flatnonzero(row >= 0), row[row >= 0]
    for read in terms:
        factor = grid.known[events, (CONSTANT, *axis.factors).index(read.factor)]
        seen = motion[events, order, axis.states.index(read.state)]
        column[row] += sign * grid.scale[output] * factor * seen
    return column


def _late(output: str, laid: AxisAssembly, y: FloatArray) -> FloatArray:
    """Return the derivative of the outputs by the delay of one of them, from the output's own course (N,)."""
    column = np.zeros(len(y))
    for rows in (named[output] for named in laid.rows if output in named):
        column[rows] = -np.gradient(y[rows], laid.t[rows], edge_order=2)
    return column


def _by_force(
    place: Place, problem: AxisProblem, laid: AxisAssembly, at: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the derivative (N,) of the outputs by the factor of an added term or of a known moment."""
    forces = [(TERM, text) for text in problem.terms] + [*problem.axis.moments]
    alone = {**problem.values, **{other: float(other == place) for other in forces}}
    forced = lay_out(replace(problem, values=alone)).grid.forced
    step = STEP / max(float(np.max(np.abs(forced))), 1e-300)
    now = laid.grid.forced if len(laid.grid.forced) else np.zeros_like(forced)
    ends = [laid.grid._replace(forced=now + by * forced) for by in (step, -step)]
    up, down = (outputs_of(replace(laid, grid=end), *at) for end in ends)
    return (up - down) / (2.0 * step)


def with_hidden(problem: AxisProblem, fit: Solution) -> AxisProblem:
    """Return the problem with the hidden state of a fit's model as a signal of every record."""
    laid, hidden = fit.assembly, problem.axis.hidden
    made = simulate(laid, fit.optimum.shared, fit.optimum.local)
    if made is None:
        return problem
    grid, records = laid.grid, []
    for m, record in enumerate(problem.records):
        events = slice(grid.first[m], grid.first[m + 1])
        t = laid.begin[m] + np.concatenate([[0.0], np.cumsum(grid.step_s[events][:-1])])
        course = Signal(t, made[2][events, 0, problem.axis.states.index(hidden)])
        records.append(replace(record, signals={**record.signals, hidden: course}))
    return replace(problem, records=tuple(records))
