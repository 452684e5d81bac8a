"""The estimation problem: data, simulation, and a point in the space of the parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise

import numpy as np

from advisor.gap.fitting.prior import ERROR_IF_WRONG, holding, prior_precision, small_without_alpha
from advisor.gap.fitting.whitening import Filters, Whitening
from advisor.gap.kit.effect import Values, Variant
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, FILTER, INDEX, LAYOUT, NUISANCES, SKEWS
from advisor.gap.simulator.pack import LANES
from advisor.gap.simulator.reading import filtered, lane, packed, read_late, read_rows
from advisor.gap.simulator.simulate import simulate
from advisor.gap.simulator.surface import surfaces
from advisor.process.arrays import FloatArray

_NO_DISTURBANCE = np.zeros((4, 0))
"""Numerical: response of the four outputs to no disturbance."""
_SKEW_ENTRIES = np.array([INDEX[name] for name in SKEWS])
_FILTER_ENTRIES = np.array([INDEX[name] for name in FILTER])
_FLOWN_ENTRIES = np.array([i for i, name in enumerate(ENTRIES) if name not in (*SKEWS, *FILTER)])
_FLAT = 1e6
"""Numerical: prior standard deviation of a nuisance parameter whose prior is not stated."""


@dataclass(frozen=True)
class SearchPoint:
    """One point of the search: all parameters of the simulation."""

    derivatives: FloatArray
    """Shape (6,): derivatives of Eqs. (1)-(2)."""
    own: FloatArray
    """Shape (manoeuvres, 4): initial states and trim terms of each manoeuvre."""
    effects: tuple[Variant, ...] = ()
    values: tuple[FloatArray, ...] = ()
    """Parameters of each effect, in the order of ``effects``."""
    sides: FloatArray | None = None
    """Shape (manoeuvres,): chosen sign of the effect in each manoeuvre, for an effect whose sign may
    differ."""
    edges: tuple[FloatArray, ...] | None = None
    """Per manoeuvre, shape (edges,): shift of each edge of the command from its stamps, in intervals. The
    outputs are linear in the edges' shifts, so the shifts are not simulated."""

    @property
    def shared(self) -> FloatArray:
        """All shared parameters as one vector: derivatives, then parameters of the effects."""
        return np.concatenate([self.derivatives, *self.values])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the derivatives, then of the effects' parameters, in the order of ``shared``."""
        return (*DERIVATIVES, *(name for effect in self.effects for name in effect.names))

    def moved(self, shared: FloatArray, own: FloatArray) -> "SearchPoint":
        """Return the model with other shared and nuisance parameters."""
        ends = accumulate((len(effect.names) for effect in self.effects), initial=len(self.derivatives))
        values = tuple(shared[begin:end] for begin, end in pairwise(ends))
        return replace(self, derivatives=shared[: len(DERIVATIVES)], own=own, values=values)

    def place(self, k: int) -> slice:
        """Return the place of the ``k``-th effect's parameters among the shared parameters."""
        begin = len(self.derivatives) + sum(len(effect.names) for effect in self.effects[:k])
        return slice(begin, begin + len(self.effects[k].names))

    def index_of(self, name: str) -> int:
        """Return the index of the effect with this name.

        Raises
        ------
        ValueError
            No effect has the name.
        """
        return [effect.effect for effect in self.effects].index(name)

    def with_effect(
        self, effect: Variant, values: Sequence[float] | FloatArray, sides: FloatArray | None = None
    ) -> "SearchPoint":
        """Return the model with one more effect in it."""
        return replace(
            self,
            effects=(*self.effects, effect),
            values=(*self.values, np.asarray(values, float)),
            sides=self.sides if sides is None else sides,
        )

    def keeping(self, which: Sequence[int]) -> "SearchPoint":
        """Return the model with the effects of the given indices."""
        return replace(
            self, effects=tuple(self.effects[k] for k in which), values=tuple(self.values[k] for k in which)
        )


@dataclass(frozen=True)
class EffectProblem:
    """The data, the fixed part of the simulation, the prior, and the command's motion between stamps."""

    flights: PreparedManeuvers
    base: FloatArray
    """Simulator inputs from the aircraft file, shape (entries,), or (manoeuvres, entries) if they differ."""
    held: bool = False
    """Whether the command is held between its stamps; otherwise it moves linearly."""
    instruments: FloatArray | None = None
    """Shape (channels,): noise of the instruments alone, without moving air."""
    smallest_noise: FloatArray | None = None
    """Shape (channels,): lower bound of the innovations' noise."""
    prior_derivatives: FloatArray | None = None
    """Shape (6,): derivatives of the aircraft file; None where the file lacks one."""
    jitter_s: float = 0.0
    """Standard deviation of the time error of all stamps, s."""
    whitening: Whitening | None = None
    """Filter of moving air and coloured instruments; None where the residual is white."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Derivatives that the user holds at a value, by name."""
    changes: tuple[tuple[Variant, Values], ...] = ()
    """Changes in flight from the aircraft file, with their sizes, which scale derivatives."""

    @property
    def knows_the_noise(self) -> bool:
        """Whether innovations come in units of their own standard deviation."""
        return isinstance(self.whitening, Filters)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the outputs that the fit compares with the measurement."""
        return self.flights.channels

    def with_own(self, point: SearchPoint, owns: Sequence[FloatArray]) -> SearchPoint:
        """Return the point after a step of the nuisance parameters, each of shape (m,).

        Initial states and trim terms come first. Edges come last, as places instead of steps.
        """
        n = point.own.shape[1]
        pairs = zip(owns, self.flights.flights, strict=True)
        edges = tuple(own[len(own) - len(flight.edges) :] for own, flight in pairs)
        return replace(point, own=point.own + np.array([own[:n] for own in owns]), edges=edges)

    def prior_of(self, point: SearchPoint) -> tuple[FloatArray, FloatArray]:
        """Return inverse prior variances of the shared parameters, and the prior mean minus them, (k,).

        The prior mean of a derivative is the file's value; that of a nuisance parameter is zero. The prior is
        weak and decides only where the data do not. Without a measured angle of attack Z_q and Z_δe also have
        the prior of the estimate, about zero.
        """
        if self.prior_derivatives is None:
            return self.prior_about(point, np.zeros(len(DERIVATIVES)), point.derivatives)
        precision = prior_precision(self.prior_derivatives, ERROR_IF_WRONG)
        return self.prior_about(point, precision, self.prior_derivatives)

    def prior_about(
        self, point: SearchPoint, precision: FloatArray, mean: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return ``prior_of`` for inverse variances and means of the derivatives, shape (6,) each."""
        if "alpha" not in self.channels:
            small = small_without_alpha(point.derivatives)
            mean = precision * mean / np.maximum(precision + small, 1e-300)
            precision = precision + small
        precision, mean = holding(precision, mean, self.fixed)
        stds = [effect.prior_std or (_FLAT,) * len(effect.names) for effect in point.effects]
        widths = np.concatenate([[], *stds])
        means = np.concatenate([mean, np.zeros(len(widths))])
        return np.concatenate([precision, widths**-2.0]), means - point.shared

    def prior_cost(self, point: SearchPoint) -> float:
        """Return the prior's contribution to the cost."""
        inverse, departure = self.prior_of(point)
        return float(inverse @ departure**2)

    def driving(self, point: SearchPoint) -> FloatArray:
        """Return the driving numbers of each manoeuvre's simulation, shape (manoeuvres, entries)."""
        p = np.empty((len(self.flights), self.base.shape[-1]))
        p[:] = self.base
        p[:, : len(DERIVATIVES)] += point.derivatives
        p[:, len(DERIVATIVES) : len(DERIVATIVES) + len(NUISANCES)] = point.own
        if point.sides is not None:
            p[:, INDEX["play_side"]] = point.sides
        for effect, values in (*self.changes, *zip(point.effects, point.values, strict=True)):
            effect.apply(p, values, self.flights)
        return p

    def fly_all(
        self,
        flight: PreparedManeuver,
        p: FloatArray,
        disturbance: FloatArray = _NO_DISTURBANCE,
        doses: FloatArray | None = None,
    ) -> FloatArray:
        """Return one manoeuvre simulated with every row of ``p``, shape (k, entries), in packs for
        ``read_all``.

        The disturbance, shape (4, n), enters each simulation multiplied by its factor in ``doses``, shape
        (k,).
        """
        t, u = flight.command(self.held)
        moved = surfaces(LAYOUT, flight.h, flight.n, t, u, self.held, flight.u_trim, p)
        doses = np.zeros(len(p)) if doses is None else doses
        return simulate(LAYOUT, flight.h, *moved, LANES, flight.slow, disturbance, doses, flight.trim, p)

    def read_all(self, flight: PreparedManeuver, packs: FloatArray, p: FloatArray) -> FloatArray:
        """Return all channels at their stamps, stacked, shape (rows, k), with the instruments in ``p``."""
        return self._read(flight, packs, np.arange(len(p)), p)

    def fly_and_read(self, flight: PreparedManeuver, p: FloatArray) -> FloatArray:
        """Return the readings of one manoeuvre in simulations with every row of ``p`` (k, entries), shape
        (rows, k).

        Rows that differ only in the instruments' stamps or filters share a simulation.
        """
        alike = [row.tobytes() for row in p[:, _FLOWN_ENTRIES]]
        places = {row: k for k, row in enumerate(dict.fromkeys(alike))}
        first = [alike.index(row) for row in places]
        return self._read(flight, self.fly_all(flight, p[first]), np.array([places[row] for row in alike]), p)

    def _read(
        self, flight: PreparedManeuver, packs: FloatArray, flown: np.ndarray, p: FloatArray
    ) -> FloatArray:
        skews, filters = p[:, _SKEW_ENTRIES], p[:, _FILTER_ENTRIES]
        if np.any(filters[:, 0] > 0.0):
            packs, flown = filtered(packs, flight.h, flown, filters), np.arange(len(p))
        return np.asarray(read_rows(packs, flight.h, flight.stamps, flight.output, flown, skews))

    def fly(self, flight: PreparedManeuver, p: FloatArray) -> FloatArray:
        """Return the simulated outputs of one manoeuvre on the time grid, shape (4, n + 1)."""
        return lane(self.fly_all(flight, p[None]), 0)

    def read_delayed(
        self, flight: PreparedManeuver, response: FloatArray, delays: FloatArray, p: FloatArray
    ) -> FloatArray:
        """Return one series of outputs, delayed by each of ``delays``, at the channels' stamps, shape (rows,
        k)."""
        if np.any(p[_FILTER_ENTRIES[:1]] > 0.0):
            # Nothing comes before the response.
            begun = packed([np.pad(response, ((0, 0), (1, 0)))])
            filters = p[None, _FILTER_ENTRIES]
            response = lane(filtered(begun, flight.h, np.zeros(1, np.int64), filters)[:, 1:], 0)
        skews = p[_SKEW_ENTRIES]
        return np.asarray(read_late(response, flight.h, flight.stamps, flight.output, skews, delays))

    def read(self, flight: PreparedManeuver, grid: FloatArray, p: FloatArray) -> FloatArray:
        """Return one series of outputs on the time grid, read at the channels' stamps, shape (rows,)."""
        return self.read_all(flight, packed([grid]), p[None])[:, 0]

    def rows(self, flight: PreparedManeuver) -> list[slice]:
        """Return the rows of each channel in the stacked vector of one manoeuvre."""
        out, at = [], 0
        for c in self.channels:
            out.append(slice(at, at + len(flight.outputs[c].t)))
            at = out[-1].stop
        return out

    def measured(self, flight: PreparedManeuver) -> FloatArray:
        """Return all measured channels of one manoeuvre, stacked, shape (rows,)."""
        return np.concatenate([flight.outputs[c].y for c in self.channels])

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Return the columns of manoeuvre ``i``, shape (rows, k), whitened where the noise is coloured."""
        return columns if self.whitening is None else self.whitening.innovations(i, columns)


def row_weights(problem: EffectProblem, i: int, weights: FloatArray) -> FloatArray:
    """Return one weight for each row of manoeuvre ``i``."""
    flight = problem.flights.flights[i]
    return np.concatenate(
        [np.full(len(flight.outputs[c].t), w) for c, w in zip(problem.channels, weights, strict=True)]
    )


def counts(problem: EffectProblem) -> FloatArray:
    """Return the number of samples of each channel over all manoeuvres, shape (channels,)."""
    return np.array(
        [sum(len(f.outputs[c].t) for f in problem.flights.flights) for c in problem.channels], float
    )
