"""The linear model about a point: sensitivities to shared and to each manoeuvre's nuisance parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from advisor.gap.fitting.prior import own_mean, own_precision
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import DISTURB_INPUT, INDEX, NUISANCES, OUTPUTS, SPEED
from advisor.gap.simulator.reading import differences, lane
from advisor.process.arrays import FloatArray

_DERIVATIVE_STEP = 1e-3
"""Numerical: finite-difference step of a derivative, relative to its size: far above rounding, far below
curvature."""
_LEAST_SCALE = np.array([0.5, 0.05, 0.1, 1.0, 0.5, 1.0])
"""Numerical: least size of each derivative for its finite-difference step, in the units of
``DERIVATIVES``."""
_NEAR, _STEPS = 0.02, 2.0
"""Numerical: largest change of parameters within which sensitivities to nuisance parameters are reused. The
change of a derivative is relative to its size; that of an effect's parameter is in steps."""
_OWN_STEPS = np.array([1e-4, 1e-4, 1e-3, 1e-3])
"""Numerical: finite-difference steps of initial states (rad, rad/s) and trim terms (1/s, 1/s²)."""
_OFFSETS = {"a_z": 0.5, "theta": 0.035}
"""Prior: standard deviation of an instrument's offset in a manoeuvre, by channel, SI. An uncalibrated
accelerometer is off by 0.05 g, and an attitude by 2 deg."""
_SPEEDS = ("speed_level_m_s", "speed_slope_m_s", "speed_bow_m_s")
_SPEED_STEP = 1e-3
"""Numerical: finite-difference step of the air speed, relative."""
_TIMES = frozenset({"latency_s", "delay_s", "skew_s"})
"""Parameters that shift the response to an edge as a whole."""
_PULSE = 1e-4
"""Numerical: area of the disturbance that measures a pulse response: small enough for a linear response."""
_EDGE_VARIANCE = 1.0 / 12.0
"""Prior: variance of an edge's position between two stamps, in squared intervals: uniform over the
interval."""
_SHARES = (1.0 / 6.0, 0.5, 5.0 / 6.0)
"""Numerical: positions of three pulses, as shares of the time in which a servo runs at its limit."""
_HELD_JITTER_S = 0.0015
"""Prior: standard deviation in s of the time at which a held command changes, relative to its stamp: the
stamp's resolution."""


@dataclass(frozen=True)
class SensitivityColumns:
    """Residual and sensitivities of one manoeuvre, as the columns of one array."""

    columns: FloatArray
    """Shape (rows, m + k + 1): sensitivities to m nuisance and k shared parameters, and the residual."""
    m: int

    @property
    def own(self) -> FloatArray:
        """Shape (rows, m): sensitivities to initial states, trim, offsets, air speed errors and edges."""
        return self.columns[:, : self.m]

    @property
    def shared(self) -> FloatArray:
        """Shape (rows, k): sensitivities to the shared parameters."""
        return self.columns[:, self.m : -1]

    @property
    def residual(self) -> FloatArray:
        """Shape (rows,): measured minus simulated outputs."""
        return self.columns[:, -1]

    def after(self, step: FloatArray, own: FloatArray) -> FloatArray:
        """Return the residual after a step of the shared and the nuisance parameters."""
        return np.asarray(self.columns @ _stepped(step, own))


@dataclass(frozen=True)
class Linear(SensitivityColumns):
    """Linear model of one manoeuvre about a point, whose rows are unweighted innovations."""

    prior: FloatArray
    """Shape (m,): inverse prior variances of the nuisance parameters, 0 for flat priors."""
    departure: FloatArray
    """Shape (m,): prior means of the nuisance parameters minus their values at the point."""
    measured: SensitivityColumns
    """Residual and sensitivities in the units of the channels, before the filter."""
    channels: tuple[slice, ...]
    """Rows of each channel in the stacked vector."""

    @cached_property
    def products(self) -> FloatArray:
        """Shape (channels, m + k + 1, m + k + 1): inner products of all columns, by channel.

        Every normal equation is a weighted sum of these products, so new weights need no pass over the rows.
        """
        return np.stack([self.columns[rows].T @ self.columns[rows] for rows in self.channels])

    def squares_after(self, step: FloatArray, own: FloatArray) -> FloatArray:
        """Return the sum of squares of the residual after a step of shared and nuisance parameters, shape
        (channels,)."""
        after = _stepped(step, own)
        return np.asarray(np.maximum(self.products @ after @ after, 0.0))


def _stepped(step: FloatArray, own: FloatArray) -> FloatArray:
    """Return the column weights whose sum is the residual after a step."""
    return np.concatenate([-own, -step, [1.0]])


def as_measured(block: Linear) -> Linear:
    """Return the linear model without a filter, in the units of the channels."""
    raw = block.measured
    return Linear(raw.columns, raw.m, block.prior, block.departure, raw, block.channels)


def shared_steps(point: SearchPoint) -> FloatArray:
    """Return the finite-difference steps of the shared parameters."""
    return np.concatenate([_DERIVATIVE_STEP * _scale(point), *[np.array(e.steps) for e in point.effects]])


def _scale(point: SearchPoint) -> FloatArray:
    """Return the size of each derivative that scales its finite-difference step, shape (6,)."""
    return np.asarray(np.maximum(np.abs(point.derivatives), _LEAST_SCALE))


def are_near(point: SearchPoint, other: SearchPoint) -> bool:
    """Return whether sensitivities to nuisance parameters are nearly equal at two points of a model."""
    reach = np.concatenate([_NEAR * _scale(point), *[_STEPS * np.array(e.steps) for e in point.effects]])
    return bool(np.all(np.abs(other.shared - point.shared) <= reach))


def shifted_points(point: SearchPoint, which: range) -> list[SearchPoint]:
    """Return one point for each shared parameter, with this parameter moved by its step."""
    shifts = np.diag(shared_steps(point))[which]
    return [point.moved(point.shared + shift, point.own) for shift in shifts]


def measured_columns(
    problem: EffectProblem,
    i: int,
    p: FloatArray,
    shifted: FloatArray,
    steps: FloatArray,
    edges: FloatArray | None,
    times: Sequence[int],
    answers: FloatArray | None = None,
) -> SensitivityColumns:
    """Return residual and sensitivities of manoeuvre ``i`` in its channels' units, by one-sided differences.

    Sensitivities to edges are shifted responses to an impulse at the start, because the model is nearly
    linear and nearly time-invariant over a manoeuvre. All other sensitivities are simulated.

    Parameters
    ----------
    p
        Shape (entries,): simulator inputs of the point.
    shifted
        Shape (k, entries): simulator inputs with each shared parameter moved by its step.
    steps
        Shape (k,): steps of the shared parameters.
    edges
        Shape (edges,): places of the command's edges; None if their sensitivities are not needed.
    times
        Indices of the shared parameters that shift the edges.
    answers
        Shape (rows, m - edges): known sensitivities to nuisance parameters other than edges, or None.
    """
    flight, k = problem.flights.flights[i], len(steps)
    names = () if answers is not None else (*NUISANCES, *_SPEEDS[: len(flight.speed_error_factor)])
    moves = np.array([*_OWN_STEPS, *[_SPEED_STEP * flight.slow[SPEED, 0]] * len(_SPEEDS)])[: len(names)]
    rows = np.repeat(p[None], 1 + k + len(names) + 1, axis=0)
    rows[1 : k + 1] = shifted
    rows[range(k + 1, len(rows) - 1), [INDEX[name] for name in names]] += moves
    doses = np.zeros(len(rows))
    doses[-1] = _PULSE
    packs = problem.fly_all(flight, rows, unit_pulse(flight, DISTURB_INPUT, p[INDEX["lag_s"]]), doses)
    read = problem.read_all(flight, packs, rows[:-1])
    moved = np.concatenate([[0.0], steps, moves])
    seen = differences(read, problem.measured(flight), np.zeros(len(moved), dtype=np.int64), moved)
    residual, shared, own_known = seen[:, :1], seen[:, 1 : k + 1], answers
    if own_known is None:
        own, speeds = seen[:, k + 1 :][:, : len(NUISANCES)], seen[:, k + 1 + len(NUISANCES) :]
        own_known = np.hstack([own, _offsets(problem, flight), speeds @ flight.speed_error_factor])
    pulse = (lane(packs, len(rows) - 1) - lane(packs, 0)) / _PULSE
    to_edges = _answers_to_edges(problem, flight, pulse, p)
    if edges is not None:
        for time in times:
            # Delay and latency shift the response to moved edges, a skew shifts its reading.
            turned = _answers_to_edges(problem, flight, pulse, shifted[time]) - to_edges
            shared[:, time] += turned @ edges / steps[time]
    columns = np.hstack([own_known, to_edges, shared, residual])
    return SensitivityColumns(columns, columns.shape[1] - k - 1)


def _answers_to_edges(
    problem: EffectProblem, flight: PreparedManeuver, pulse: FloatArray, p: FloatArray
) -> FloatArray:
    """Return the change of the outputs when each edge moves by its interval, shape (rows, edges)."""
    delays, areas = _pulses(problem, flight, p)
    parts = [problem.read_delayed(flight, pulse, begin, p) * areas for begin in delays]
    return np.asarray(sum(parts))


def _pulses(
    problem: EffectProblem, flight: PreparedManeuver, p: FloatArray
) -> tuple[list[FloatArray], FloatArray]:
    """Return the delays and areas of pulses that equal a move of each edge by its interval."""
    # A servo at its limit moves on after the edge, and the move delays all that motion.
    begin = flight.edges[:, 0] + p[INDEX["delay_s"]] + p[INDEX["latency_s"]]
    if problem.held:
        begin += 0.5 * (flight.edges[:, 2] - flight.edges[:, 3])
    area, interval = flight.edges[:, 1], flight.edges[:, 2]
    longer = np.maximum(np.abs(area / interval) * p[INDEX["slowness_s_rad"]] - interval, 0.0)
    if not np.any(longer > 0.0):
        return [begin], area
    return [begin + share * longer for share in _SHARES], area / len(_SHARES)


def _offsets(problem: EffectProblem, flight: PreparedManeuver) -> FloatArray:
    """Return the constant offsets of accelerometer and attitude, shape (rows, offsets)."""
    return np.column_stack(
        [flight.output == OUTPUTS.index(c) for c in _OFFSETS if c in problem.channels]
        or [np.empty((len(flight.stamps), 0))]
    ).astype(float)


def _own_prior(problem: EffectProblem, flight: PreparedManeuver, own: int) -> FloatArray:
    """Return inverse prior variances (own,): initial states, trim, offsets, air speed, edges; 0 if flat."""
    prior = np.zeros(own)
    prior[: len(NUISANCES)] = own_precision(flight)
    offsets = [_OFFSETS[c] for c in _OFFSETS if c in problem.channels]
    prior[len(NUISANCES) : len(NUISANCES) + len(offsets)] = 1.0 / np.square(offsets)
    intervals, lost = flight.edges[:, 2], flight.edges[:, 3]
    # Where stamps were lost, a held command may have changed at any of them.
    held = (_HELD_JITTER_S**2 + problem.jitter_s**2 + _EDGE_VARIANCE * lost**2) / intervals**2
    edges = own - len(intervals)
    prior[edges - len(flight.speed_error_factor) : edges] = 1.0
    prior[edges:] = 1.0 / (held if problem.held else _EDGE_VARIANCE)
    return prior


def pulse_response(problem: EffectProblem, flight: PreparedManeuver, p: FloatArray, where: int) -> FloatArray:
    """Return the response on the grid, shape (4, n + 1), to a unit-area disturbance at the record's start.

    ``where`` is a row of the disturbances of ``advisor.gap.simulator.simulate``.
    """
    packs = problem.fly_all(flight, np.stack([p, p]), unit_pulse(flight, where), np.array([0.0, _PULSE]))
    return (lane(packs, 1) - lane(packs, 0)) / _PULSE


def unit_pulse(flight: PreparedManeuver, where: int, lag_s: float = 0.0) -> FloatArray:
    """Return a disturbance of unit area at the start of the record, shape (4, n).

    With ``lag_s`` above zero the disturbance passes a first-order lag, like that of a servo.
    """
    disturbance = np.zeros((4, flight.n))
    if lag_s > 1e-3:
        shape = np.exp(-(np.arange(flight.n) + 0.5) * flight.h / lag_s)
        disturbance[where] = shape / (np.sum(shape) * flight.h)
    else:
        disturbance[where, 0] = 1.0 / flight.h
    return disturbance


def linearise(
    problem: EffectProblem, point: SearchPoint, near: Sequence[Linear] | None = None, shared: bool = True
) -> tuple[Linear, ...]:
    """Return the linear model of all manoeuvres about a point.

    ``near`` is a linear model about a nearby point, whose sensitivities to nuisance parameters other than
    edges are reused. ``shared`` is False where no sensitivities to shared parameters are needed.

    Edges of the command may lie far from their stamps, as in a command logged 25 times per second. A search
    with constant sensitivities to edges would diverge while a delay changes. Such a search would end at a
    false optimum, where the gradient of the cost does not vanish.
    """
    p, steps = problem.driving(point), shared_steps(point) if shared else np.empty(0)
    there = shifted_points(point, range(len(steps)))
    shifted = np.array([problem.driving(moved) for moved in there]).reshape(len(steps), *p.shape)
    times = [k for k, name in enumerate(point.names) if shared and name in _TIMES]
    blocks = []
    for i, flight in enumerate(problem.flights.flights):
        moved = None if point.edges is None or not times else point.edges[i]
        answers = None if near is None else near[i].measured.own[:, : near[i].m - len(flight.edges)]
        measured = measured_columns(problem, i, p[i], shifted[:, i], steps, moved, times, answers)
        prior, departure = _own_prior(problem, flight, measured.m), np.zeros(measured.m)
        departure[: len(NUISANCES)] = own_mean(flight) - point.own[i]
        columns = problem.innovations(i, measured.columns)
        blocks.append(Linear(columns, measured.m, prior, departure, measured, tuple(problem.rows(flight))))
    return tuple(blocks)
