"""The model about a point: sensitivities to shared numbers and to each manoeuvre's own."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.problem import Point, Problem
from advisor.gap.records.flights import Flight
from advisor.gap.simulator.layout import DISTURB_INPUT, INDEX, NUISANCES, OUTPUTS, SPEED
from advisor.gap.simulator.reading import differences, lane, packed, superposed

_DERIVATIVE_STEP = 1e-3
"""Finite-difference step of a derivative, relative to its size: far above rounding, far below curvature."""
_LEAST_SCALE = np.array([0.5, 0.05, 0.1, 1.0, 0.5, 1.0])
"""Least size that a derivative is taken to have."""
_NEAR, _STEPS = 0.02, 2.0
"""Change of each derivative, relative to its size, and of an effect's numbers, in steps of theirs, over which
answers to a manoeuvre's own numbers stay what they are."""
_OWN_STEPS = np.array([1e-4, 1e-4, 1e-3, 1e-3])
"""Of initial states (rad, rad/s) and trim terms (1/s, 1/s²)."""
_SPEEDS = ("speed_level_m_s", "speed_slope_m_s", "speed_bow_m_s")
_SPEED_STEP = 1e-3
"""Of the air speed, relative."""
_TIMES = frozenset({"latency_s", "delay_s", "skew_s"})
"""Numbers that shift the answer to an edge as a whole."""
_PULSE = 1e-4
"""Area of the disturbance by which a response to a pulse is found."""
_EDGE_VARIANCE = 1.0 / 12.0
"""An edge of a linear command lies anywhere between two stamps: uniform over the interval."""
_SHARES = (1.0 / 6.0, 0.5, 5.0 / 6.0)
"""Where in the time that a servo runs on its lateness is put: at the middles of thirds."""
_HELD_JITTER_S = 0.0015
"""A held command changes at its stamp, give or take the stamp's resolution."""


@dataclass(frozen=True)
class Columns:
    """Residual and sensitivities of one manoeuvre, side by side: what is done to them is done at once."""

    columns: FloatArray
    """Shape (rows, m + k + 1): own, shared, left."""
    m: int

    @property
    def own(self) -> FloatArray:
        """Shape (rows, m): initial states, trim, offsets (flat priors), then errors of the speed, edges."""
        return self.columns[:, : self.m]

    @property
    def shared(self) -> FloatArray:
        """Shape (rows, k)."""
        return self.columns[:, self.m : -1]

    @property
    def residual(self) -> FloatArray:
        """Shape (rows,): measured minus simulated."""
        return self.columns[:, -1]

    def after(self, step: FloatArray, own: FloatArray) -> FloatArray:
        """Residual after a step of the shared and the own numbers."""
        return np.asarray(self.columns @ _stepped(step, own))


@dataclass(frozen=True)
class Linear(Columns):
    """The model of one manoeuvre made linear about a point, as innovations, before weighting."""

    prior: FloatArray
    """Shape (m,): inverse prior variances, 0 for flat."""
    measured: Columns
    """The same in the units of the channels, as it was before the filter."""
    channels: tuple[slice, ...]
    """The rows of each channel."""

    @cached_property
    def products(self) -> FloatArray:
        """Shape (channels, m + k + 1, m + k + 1): of own, shared and left with one another, by channel.

        Every normal equation is a weighted sum of them: weights may change without a look at the rows.
        """
        return np.stack([self.columns[rows].T @ self.columns[rows] for rows in self.channels])

    def squares_after(self, step: FloatArray, own: FloatArray) -> FloatArray:
        """Shape (channels,): of the residual after a step of the shared and the own numbers."""
        after = _stepped(step, own)
        return np.asarray(np.maximum(self.products @ after @ after, 0.0))


def _stepped(step: FloatArray, own: FloatArray) -> FloatArray:
    """What the columns are summed with to give the residual after a step."""
    return np.concatenate([-own, -step, [1.0]])


def as_measured(block: Linear) -> Linear:
    """The same without a filter: in the units of the channels."""
    raw = block.measured
    return Linear(raw.columns, raw.m, block.prior, raw, block.channels)


def shared_steps(point: Point) -> FloatArray:
    """Finite-difference steps of the shared numbers."""
    return np.concatenate([_DERIVATIVE_STEP * _scale(point), *[np.array(e.steps) for e in point.effects]])


def _scale(point: Point) -> FloatArray:
    """Of each derivative, shape (6,)."""
    return np.asarray(np.maximum(np.abs(point.derivatives), _LEAST_SCALE))


def are_near(one: Point, other: Point) -> bool:
    """Whether initial states, trims and air speeds have nearly the same answers at two points of a model."""
    reach = np.concatenate([_NEAR * _scale(one), *[_STEPS * np.array(e.steps) for e in one.effects]])
    return bool(np.all(np.abs(other.shared - one.shared) <= reach))


def shifted_points(point: Point, which: range) -> list[Point]:
    """The point with one of the shared numbers after the other moved by its step."""
    shifts = np.diag(shared_steps(point))[which]
    return [point.moved(point.shared + shift, point.own) for shift in shifts]


def measured_columns(
    problem: Problem,
    i: int,
    p: FloatArray,
    shifted: FloatArray,
    steps: FloatArray,
    edges: FloatArray | None,
    times: Sequence[int],
    answers: FloatArray | None = None,
) -> Columns:
    """Manoeuvre ``i`` in the units of its channels; sensitivities are one-sided differences.

    Of its own numbers all but the edges are simulated, which are shifted responses to an impulse at the start
    (the model is nearly linear and nearly time-invariant over a manoeuvre).

    Parameters
    ----------
    p
        Shape (entries,): where.
    shifted
        Shape (k, entries): the same with each of the shared numbers moved by its step ...
    steps
        ... shape (k,).
    edges
        Shape (edges,): where the command's are, or None if their answers are not looked at ...
    times
        ... which of the shared numbers shift them.
    answers
        Shape (rows, m - edges): to own numbers other than edges, where they are known.
    """
    flight, k = problem.flights.flights[i], len(steps)
    names = () if answers is not None else (*NUISANCES, *_SPEEDS[: len(flight.speed_error_factor)])
    moves = np.array([*_OWN_STEPS, *[_SPEED_STEP * flight.slow[SPEED, 0]] * len(_SPEEDS)])[: len(names)]
    others = np.tile(p, (len(names), 1))
    others[range(len(names)), [INDEX[name] for name in names]] += moves
    rows = np.vstack([p, shifted, others, p])
    doses = np.zeros(len(rows))
    doses[-1] = _PULSE
    packs = problem.fly_all(flight, rows, unit_pulse(flight, DISTURB_INPUT, p[INDEX["lag_s"]]), doses)
    read = problem.read_all(flight, packs, rows[:-1])
    moved = np.concatenate([[0.0], steps, moves])
    seen = differences(read, problem.measured(flight), np.zeros(len(moved), dtype=np.int64), moved)
    residual, shared = seen[:, :1], seen[:, 1 : k + 1]
    if answers is None:
        own, speeds = seen[:, k + 1 :][:, : len(NUISANCES)], seen[:, k + 1 + len(NUISANCES) :]
        answers = np.hstack([own, _offsets(problem, flight), speeds @ flight.speed_error_factor])
    pulse = (lane(packs, len(rows) - 1) - lane(packs, 0)) / _PULSE
    if edges is not None:
        with_them = rows[[0, *(1 + k for k in times)]]
        shared[:, times] += _turned(problem, flight, pulse, edges, with_them) / steps[times]
    columns = np.hstack([answers, _answers_to_edges(problem, flight, pulse, p), shared, residual])
    return Columns(columns, columns.shape[1] - k - 1)


def _answers_to_edges(problem: Problem, flight: Flight, pulse: FloatArray, p: FloatArray) -> FloatArray:
    """Shape (rows, edges): what a shift of each edge by its interval changes."""
    delays, areas = _pulses(problem, flight, p)
    parts = [problem.read_delayed(flight, pulse, begin, p) * areas for begin in delays]
    return np.asarray(sum(parts))


def _pulses(problem: Problem, flight: Flight, p: FloatArray) -> tuple[list[FloatArray], FloatArray]:
    """Where the pulses are that a shift of each edge by its interval is like, and the area of each.

    That is one pulse at the edge. A servo at its limit runs on after it, and is later all that time.
    """
    begin = flight.edges[:, 0] + p[INDEX["delay_s"]] + p[INDEX["latency_s"]]
    if problem.held:
        begin += 0.5 * (flight.edges[:, 2] - flight.edges[:, 3])
    area, interval = flight.edges[:, 1], flight.edges[:, 2]
    longer = np.maximum(np.abs(area / interval) * p[INDEX["slowness_s_rad"]] - interval, 0.0)
    if not np.any(longer > 0.0):
        return [begin], area
    return [begin + share * longer for share in _SHARES], area / len(_SHARES)


def _offsets(problem: Problem, flight: Flight) -> FloatArray:
    """Shape (rows, offsets): constants of the accelerometer and of the attitude."""
    return np.column_stack(
        [flight.output == OUTPUTS.index(c) for c in ("a_z", "theta") if c in problem.channels]
        or [np.empty((len(flight.stamps), 0))]
    ).astype(float)


def _own_prior(problem: Problem, flight: Flight, own: int) -> FloatArray:
    """Shape (own,): inverse prior variances of a manoeuvre's own numbers, 0 for flat.

    Its edges come last, before them the errors of the air speed, which are in units of their own size.
    """
    prior = np.zeros(own)
    intervals, lost = flight.edges[:, 2], flight.edges[:, 3]
    # Where stamps were lost, a held command may have changed at any of them.
    held = (_HELD_JITTER_S**2 + problem.jitter_s**2 + _EDGE_VARIANCE * lost**2) / intervals**2
    edges = own - len(intervals)
    prior[edges - len(flight.speed_error_factor) : edges] = 1.0
    prior[edges:] = 1.0 / (held if problem.held else _EDGE_VARIANCE)
    return prior


def pulse_response(problem: Problem, flight: Flight, p: FloatArray, where: int) -> FloatArray:
    """Response on the grid, shape (4, n + 1), to a disturbance of unit area at the start of the record.

    ``where`` is a row of the disturbances of ``advisor.gap.simulator.simulate``.
    """
    packs = problem.fly_all(flight, np.stack([p, p]), unit_pulse(flight, where), np.array([0.0, _PULSE]))
    return (lane(packs, 1) - lane(packs, 0)) / _PULSE


def unit_pulse(flight: Flight, where: int, lag_s: float = 0.0) -> FloatArray:
    """A disturbance of unit area at the start of the record, shape (4, n).

    ``lag_s`` passes it through a first-order lag first, as a servo would.
    """
    disturbance = np.zeros((4, flight.n))
    if lag_s > 1e-3:
        shape = np.exp(-(np.arange(flight.n) + 0.5) * flight.h / lag_s)
        disturbance[where] = shape / (np.sum(shape) * flight.h)
    else:
        disturbance[where, 0] = 1.0 / flight.h
    return disturbance


def linearise(problem: Problem, point: Point, near: Sequence[Linear] | None = None) -> tuple[Linear, ...]:
    """The whole model made linear about a point.

    ``near`` is the same model about a point that is near, whose answers to own numbers other than edges it
    takes over.

    Where edges lie far from their stamps (a command that is logged 25 times a second), a search that took the
    answers to them to stay while a delay or a skew changes would go astray, and end where its gradient
    vanishes and the cost's does not.
    """
    p, steps = problem.driving(point), shared_steps(point)
    shifted = np.stack([problem.driving(moved) for moved in shifted_points(point, range(len(steps)))], axis=1)
    times = [k for k, name in enumerate(point.names) if name in _TIMES]
    blocks = []
    for i, flight in enumerate(problem.flights.flights):
        moved = None if point.edges is None or not times else point.edges[i]
        known = None if near is None else near[i].measured.own[:, : near[i].m - len(flight.edges)]
        measured = measured_columns(problem, i, p[i], shifted[i], steps, moved, times, known)
        prior = _own_prior(problem, flight, measured.m)
        columns = problem.innovations(i, measured.columns)
        blocks.append(Linear(columns, measured.m, prior, measured, tuple(problem.rows(flight))))
    return tuple(blocks)


def _turned(
    problem: Problem, flight: Flight, pulse: FloatArray, edges: FloatArray, rows: FloatArray
) -> FloatArray:
    """Shape (channel rows, k - 1): what the answers to moved edges change from the first of ``rows`` on.

    ``rows`` has shape (k, entries): with what the simulation is driven, and with a time moved by its step.
    Delay and latency are one to the answers, and a skew is to their reading only.
    """
    late = np.round(rows[:, INDEX["delay_s"]] + rows[:, INDEX["latency_s"]], 9).tolist()
    places = {seconds: k for k, seconds in enumerate(dict.fromkeys(late))}
    courses = []
    for seconds in places:
        delays, areas = _pulses(problem, flight, rows[late.index(seconds)])
        parts = [superposed(pulse, flight.h, begin, areas * edges) for begin in delays]
        courses.append(np.asarray(sum(parts)))
    read = problem.read_all(flight, packed(courses), rows, np.array([places[seconds] for seconds in late]))
    return read[:, 1:] - read[:, :1]
