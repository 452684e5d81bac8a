"""The model about a point: sensitivities to shared numbers and to each manoeuvre's own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.data import Flight
from advisor.gap.layout import INDEX
from advisor.gap.problem import Point, Problem
from advisor.gap.simulate import DISTURB_INPUT

_DERIVATIVE_STEP = 1e-3
_NUISANCE_STEPS = (1e-4, 1e-4)
_EDGE_VARIANCE = 1.0 / 12.0
"""An edge of a linear command lies anywhere between two stamps: uniform over the interval."""
_HELD_JITTER_S = 0.0015
"""A held command changes at its stamp, give or take the stamp's resolution."""


@dataclass(frozen=True)
class Columns:
    """Residual and sensitivities of one manoeuvre."""

    left: FloatArray
    """Shape (rows,): measured minus simulated."""
    shared: FloatArray
    """Shape (rows, k)."""
    own: FloatArray
    """Shape (rows, m): initial states, trim, offsets (flat priors), then edges."""

    def after(self, step: FloatArray, own: FloatArray) -> FloatArray:
        """Residual after a step of the shared and the own numbers."""
        return np.asarray(self.left - self.shared @ step - self.own @ own)


@dataclass(frozen=True)
class Linear(Columns):
    """The model of one manoeuvre made linear about a point, as innovations, before weighting."""

    prior: FloatArray
    """Shape (m,): inverse prior variances, 0 for flat."""
    measured: Columns
    """The same in the units of the channels, as it was before the filter."""


def as_measured(block: Linear) -> Linear:
    """The same without a filter: in the units of the channels."""
    raw = block.measured
    return Linear(raw.left, raw.shared, raw.own, block.prior, raw)


def shared_steps(point: Point) -> FloatArray:
    """Finite-difference steps of the shared numbers."""
    scale = np.maximum(np.abs(point.derivatives), np.array([0.5, 0.05, 0.1, 1.0, 0.5, 1.0]))
    return np.concatenate([_DERIVATIVE_STEP * scale, *[np.array(e.steps) for e in point.effects]])


def shared_columns(
    problem: Problem, point: Point, p: FloatArray, grids: Sequence[FloatArray], which: range
) -> list[FloatArray]:
    """Sensitivities of every manoeuvre to some of the shared numbers, by one-sided differences."""
    steps = shared_steps(point)
    base = [
        problem.read(f, g, p[i]) for i, (f, g) in enumerate(zip(problem.flights.flights, grids, strict=True))
    ]
    columns = [np.empty((len(b), len(which))) for b in base]
    for j, index in enumerate(which):
        shifted = point.shared.copy()
        shifted[index] += steps[index]
        q = problem.driving(point.moved(shifted, point.own))
        for i, flight in enumerate(problem.flights.flights):
            columns[i][:, j] = (problem.read(flight, problem.fly(flight, q[i]), q[i]) - base[i]) / steps[
                index
            ]
    return columns


def own_columns(problem: Problem, i: int, p: FloatArray, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sensitivities of one manoeuvre to its own numbers, and their inverse prior variances.

    Two initial-state responses are simulated; trim terms are their running integrals (the model is
    nearly linear and nearly time-invariant over a manoeuvre), edges are shifted impulse responses.
    """
    flight = problem.flights.flights[i]
    base = problem.read(flight, grid, p)
    columns = []
    on_grid = []
    for name, step in zip(("alpha_start", "q_start"), _NUISANCE_STEPS, strict=True):
        q = p.copy()
        q[INDEX[name]] += step
        moved = problem.fly(flight, q)
        on_grid.append((moved - grid) / step)
        columns.append((problem.read(flight, moved, q) - base) / step)
    for response, direct in zip(on_grid, (True, False), strict=True):
        summed = flight.h * (np.cumsum(response, axis=1) - 0.5 * response)
        if direct:
            speed = flight.slow[0]
            summed[2, :-1] += speed
            summed[2, -1] += speed[-1]
        columns.append(problem.read(flight, summed, p))
    rows = problem.rows(flight)
    for name in ("a_z", "theta"):
        if name in problem.channels:
            offset = np.zeros(len(base))
            offset[rows[problem.channels.index(name)]] = 1.0
            columns.append(offset)
    flat = len(columns)
    if len(flight.edges):
        pulse = pulse_response(problem, flight, p, grid, DISTURB_INPUT, p[INDEX["lag_s"]])
        late = p[INDEX["delay_s"]] + p[INDEX["latency_s"]]
        for middle, area, interval in flight.edges:
            at = middle + late + (0.5 * interval if problem.held else 0.0)
            columns.append(area * problem.read(flight, later(pulse, at, flight.h), p))
    prior = np.zeros(len(columns))
    if len(flight.edges):
        jitter = (np.hypot(_HELD_JITTER_S, problem.jitter_s) / flight.edges[:, 2]) ** 2
        prior[flat:] = 1.0 / (jitter if problem.held else _EDGE_VARIANCE)
    own = np.column_stack(columns)
    return own, prior


def pulse_response(
    problem: Problem, flight: Flight, p: FloatArray, grid: FloatArray, where: int, lag_s: float = 0.0
) -> FloatArray:
    """Response on the grid, shape (4, n + 1), to a disturbance of unit area at the start of the record.

    ``where`` is a row of the disturbances of ``advisor.gap.simulate``; ``lag_s`` passes the pulse
    through a first-order lag first, as a servo would.
    """
    disturbance = np.zeros((4, flight.n))
    if lag_s > 1e-3:
        shape = np.exp(-(np.arange(flight.n) + 0.5) * flight.h / lag_s)
        disturbance[where] = shape / (np.sum(shape) * flight.h)
    else:
        disturbance[where, 0] = 1.0 / flight.h
    size = 1e-4
    return np.asarray((problem.fly(flight, p, size * disturbance) - grid) / size)


def later(pulse: FloatArray, at: float, h: float) -> FloatArray:
    """The same response, starting later; between two points of the grid it is mixed from both."""
    k = int(max(at, 0.0) / h)
    part = max(at, 0.0) / h - k
    out = np.zeros_like(pulse)
    n = pulse.shape[1]
    out[:, k:] = (1.0 - part) * pulse[:, : max(n - k, 0)]
    out[:, k + 1 :] += part * pulse[:, : max(n - k - 1, 0)]
    return out


def linearise(problem: Problem, point: Point) -> tuple[Linear, ...]:
    """The whole model made linear about a point."""
    p = problem.driving(point)
    lefts, grids = zip(*[problem.parts(i, p[i]) for i in range(len(problem.flights))], strict=True)
    shared = shared_columns(problem, point, p, grids, range(len(point.shared)))
    blocks = []
    for i in range(len(problem.flights)):
        own, prior = own_columns(problem, i, p[i], grids[i])
        measured = Columns(lefts[i], shared[i], own)
        if problem.whitening is None:
            blocks.append(Linear(measured.left, measured.shared, measured.own, prior, measured))
            continue
        e = problem.innovations(i, np.column_stack([lefts[i], shared[i], own]))
        k = shared[i].shape[1]
        blocks.append(Linear(e[:, 0], e[:, 1 : k + 1], e[:, k + 1 :], prior, measured))
    return tuple(blocks)
