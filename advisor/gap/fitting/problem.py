"""What is fitted to what: the data with the simulation, and a point of its numbers."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.prior import ERROR_IF_FIXED, ERROR_IF_RIGHT, ERROR_IF_WRONG, prior_precision
from advisor.gap.fitting.whitening import Filters, Whitening
from advisor.gap.records.flights import Flight, Flights
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, FILTER, INDEX, LAYOUT, NUISANCES, SKEWS
from advisor.gap.simulator.pack import LANES
from advisor.gap.simulator.reading import delayed, filtered, lane, packed, read_rows
from advisor.gap.simulator.simulate import simulate
from advisor.gap.simulator.surface import surfaces

_NO_DISTURBANCE = np.zeros((4, 0))
_SKEW_ENTRIES = np.array([INDEX[name] for name in SKEWS])
_FILTER_ENTRIES = np.array([INDEX[name] for name in FILTER])
_FLOWN_ENTRIES = np.array([i for i, name in enumerate(ENTRIES) if name not in (*SKEWS, *FILTER)])


@dataclass(frozen=True)
class Point:
    """Where the search stands: everything the simulation is driven by."""

    derivatives: FloatArray
    """Shape (6,)."""
    own: FloatArray
    """Shape (manoeuvres, 4): initial states and trim terms."""
    effects: tuple[Variant, ...] = ()
    values: tuple[FloatArray, ...] = ()
    """Parameters of each effect."""
    sides: FloatArray | None = None
    """Shape (manoeuvres,): the side chosen in each manoeuvre, for an effect that has sides."""
    edges: tuple[FloatArray, ...] | None = None
    """Per manoeuvre, shape (edges,): where each edge of the command is, in intervals from its stamps. What
    that changes is linear, and not simulated; but times shift the answers to edges, too."""

    @property
    def shared(self) -> FloatArray:
        """All shared numbers as one vector: derivatives, then parameters of effects."""
        return np.concatenate([self.derivatives, *self.values])

    @property
    def names(self) -> tuple[str, ...]:
        """Of the shared numbers, in their order."""
        return (*DERIVATIVES, *(name for effect in self.effects for name in effect.names))

    def moved(self, shared: FloatArray, own: FloatArray) -> "Point":
        """The same model elsewhere."""
        ends = accumulate((len(effect.names) for effect in self.effects), initial=len(self.derivatives))
        values = tuple(shared[begin:end] for begin, end in pairwise(ends))
        return replace(self, derivatives=shared[: len(DERIVATIVES)], own=own, values=values)

    def place(self, k: int) -> slice:
        """Where the parameters of the ``k``-th effect stand among the shared numbers."""
        begin = len(self.derivatives) + sum(len(effect.names) for effect in self.effects[:k])
        return slice(begin, begin + len(self.effects[k].names))

    def index_of(self, name: str) -> int:
        """Which of the effects has this name.

        Raises
        ------
        ValueError
            None has.
        """
        return [effect.effect for effect in self.effects].index(name)

    def with_effect(
        self, effect: Variant, values: Sequence[float] | FloatArray, sides: FloatArray | None = None
    ) -> "Point":
        """The model with one more effect in it."""
        return replace(
            self,
            effects=(*self.effects, effect),
            values=(*self.values, np.asarray(values, float)),
            sides=self.sides if sides is None else sides,
        )

    def with_only(self, names: Collection[str]) -> "Point":
        """The model with some of its effects; what is part of every model stays."""
        keep = [k for k, v in enumerate(self.effects) if v.is_nuisance or v.effect in names]
        return replace(
            self, effects=tuple(self.effects[k] for k in keep), values=tuple(self.values[k] for k in keep)
        )


@dataclass(frozen=True)
class Problem:
    """The data, the fixed part of the simulation, and how the command moved between its stamps."""

    flights: Flights
    base: FloatArray
    """Shape (entries,), or (manoeuvres, entries) where those differ: what the aircraft file has already."""
    held: bool = False
    """Command held between stamps instead of linear."""
    instruments: FloatArray | None = None
    """Shape (channels,): noise of the instruments alone, without what the air adds."""
    smallest_noise: FloatArray | None = None
    """Shape (channels,): noise of the innovations is never taken to be below this."""
    prior_derivatives: FloatArray | None = None
    """Shape (6,): derivatives of the aircraft file, when it has all ..."""
    derivatives_fixed: bool = False
    """... and whether fitted ones are held there."""
    arms_in_file: frozenset[str] = frozenset()
    """Effects whose size the aircraft file states: arms of the vane and the accelerometer."""
    jitter_s: float = 0.0
    """Standard deviation of the stamps, the command's like all others."""
    whitening: Whitening | None = None
    """Filter of moving air and coloured instruments; None where white noise describes what is left."""

    @property
    def knows_the_noise(self) -> bool:
        """Whether innovations come in units of their own standard deviation."""
        return isinstance(self.whitening, Filters)

    @property
    def channels(self) -> tuple[str, ...]:
        """Outputs that are compared."""
        return self.flights.channels

    def with_own(self, point: Point, owns: Sequence[FloatArray]) -> Point:
        """The point after a step of the manoeuvres' own numbers, each of shape (m,).

        Initial states and trim terms come first; the edges, where they are rather than by how much they move,
        last.
        """
        n = point.own.shape[1]
        found = zip(owns, self.flights.flights, strict=True)
        edges = tuple(own[len(own) - len(flight.edges) :] for own, flight in found)
        return replace(point, own=point.own + np.array([own[:n] for own in owns]), edges=edges)

    def prior_of(self, point: Point) -> tuple[FloatArray, FloatArray]:
        """Inverse variances with which shared numbers are drawn to what is expected, and what they lack.

        Both shape (k,). The derivatives are drawn to the file's, what is part of every model to nothing; far
        more weakly than by any data that say something: it decides only what the data leave open. With an
        effect in the model that derivatives imitate exactly, the file's are right within their tolerance.
        """
        inverse, expected = [np.zeros(len(DERIVATIVES))], [point.derivatives]
        if self.prior_derivatives is not None:
            trusted = any(effect.twin is not None for effect in point.effects)
            tolerance = (
                ERROR_IF_FIXED if self.derivatives_fixed else ERROR_IF_RIGHT if trusted else ERROR_IF_WRONG
            )
            inverse, expected = [prior_precision(self.prior_derivatives, tolerance)], [self.prior_derivatives]
        for effect, values in zip(point.effects, point.values, strict=True):
            inverse.append(
                1.0 / np.array(effect.prior_std) ** 2 if effect.prior_std else np.zeros(len(values))
            )
            expected.append(np.zeros(len(values)))
        return np.concatenate(inverse), np.concatenate(expected) - point.shared

    def prior_cost(self, point: Point) -> float:
        """What the pull adds to the cost."""
        inverse, departure = self.prior_of(point)
        return float(inverse @ departure**2)

    def nuisance_cost(self, point: Point) -> float:
        """The part of it that numbers have which are part of every model, beside what they usually are."""
        with_spread = (pair for pair in zip(point.effects, point.values, strict=True) if pair[0].prior_std)
        return float(
            sum(np.sum((values / np.array(effect.prior_std)) ** 2) for effect, values in with_spread)
        )

    def driving(self, point: Point) -> FloatArray:
        """Shape (manoeuvres, entries): the numbers each manoeuvre is simulated with."""
        p = np.empty((len(self.flights), self.base.shape[-1]))
        p[:] = self.base
        p[:, : len(DERIVATIVES)] = point.derivatives
        p[:, len(DERIVATIVES) : len(DERIVATIVES) + len(NUISANCES)] = point.own
        for effect, values in zip(point.effects, point.values, strict=True):
            if effect.sides is not None and point.sides is not None:
                p[:, INDEX[effect.sides[0]]] = point.sides
            effect.apply(p, values, self.flights)
        return p

    def fly_all(
        self,
        flight: Flight,
        p: FloatArray,
        disturbance: FloatArray = _NO_DISTURBANCE,
        doses: FloatArray | None = None,
    ) -> FloatArray:
        """One manoeuvre simulated with every row of ``p``, shape (k, entries), in packs for ``read_all``.

        The disturbance, shape (4, n), enters each simulation by its dose, shape (k,).
        """
        stamps = flight.t_held if self.held else flight.t_u
        command = (flight.h, flight.n, stamps, flight.u, self.held, flight.u_trim)
        delta, above = surfaces(LAYOUT, *command, p, LANES)
        doses = np.zeros(len(p)) if doses is None else doses
        return simulate(LAYOUT, flight.h, delta, above, flight.slow, disturbance, doses, flight.trim, p)

    def read_all(
        self, flight: Flight, packs: FloatArray, p: FloatArray, flown: np.ndarray | None = None
    ) -> FloatArray:
        """Shape (rows, k): all channels at their own stamps, one after another, as ``p`` has them by row.

        ``flown``, shape (k,), says which simulation each reads; each its own where it is not given.
        """
        return self._read(flight, packs, np.arange(len(p)) if flown is None else flown, p)

    def fly_and_read(self, flight: Flight, p: FloatArray) -> FloatArray:
        """Shape (rows, k): one manoeuvre as every row of ``p``, shape (k, entries), says it was measured.

        Rows that differ in what instruments do to the motion's stamps or course alone are flown once.
        """
        alike = [row.tobytes() for row in p[:, _FLOWN_ENTRIES]]
        places = {row: k for k, row in enumerate(dict.fromkeys(alike))}
        first = [alike.index(row) for row in places]
        return self._read(flight, self.fly_all(flight, p[first]), np.array([places[row] for row in alike]), p)

    def _read(self, flight: Flight, packs: FloatArray, flown: np.ndarray, p: FloatArray) -> FloatArray:
        skews, filters = p[:, _SKEW_ENTRIES], p[:, _FILTER_ENTRIES]
        if np.any(filters[:, 0] > 0.0):
            packs, flown = filtered(packs, flight.h, flown, filters), np.arange(len(p))
        return np.asarray(read_rows(packs, flight.h, flight.stamps, flight.output, flown, skews))

    def fly(self, flight: Flight, p: FloatArray) -> FloatArray:
        """Simulated outputs of one manoeuvre on the grid, shape (4, n + 1)."""
        return lane(self.fly_all(flight, p[None]), 0)

    def read_grids(self, flight: Flight, grids: Sequence[FloatArray], p: FloatArray) -> FloatArray:
        """Shape (rows, k): of series on the grid, each of shape (4, n + 1), the same."""
        return self.read_all(flight, packed(grids), np.tile(p, (len(grids), 1)))

    def read_delayed(
        self, flight: Flight, response: FloatArray, delays: FloatArray, p: FloatArray
    ) -> FloatArray:
        """Shape (rows, k): of one series that starts later by each of the delays."""
        return self.read_all(flight, delayed(response, flight.h, delays), np.tile(p, (len(delays), 1)))

    def read(self, flight: Flight, grid: FloatArray, p: FloatArray) -> FloatArray:
        """The same of one series as it is."""
        return self.read_grids(flight, [grid], p)[:, 0]

    def rows(self, flight: Flight) -> list[slice]:
        """Where each channel sits in the stacked vector of one manoeuvre."""
        out, at = [], 0
        for c in self.channels:
            out.append(slice(at, at + len(flight.outputs[c].t)))
            at = out[-1].stop
        return out

    def measured(self, flight: Flight) -> FloatArray:
        """All channels of one manoeuvre, stacked."""
        return np.concatenate([flight.outputs[c].y for c in self.channels])

    def innovations(self, i: int, columns: FloatArray) -> FloatArray:
        """Columns of manoeuvre ``i``, shape (rows, k), freed of what neighbouring rows have in common."""
        return columns if self.whitening is None else self.whitening.innovations(i, columns)


def row_weights(problem: Problem, i: int, weights: FloatArray) -> FloatArray:
    """One weight a row of manoeuvre ``i``."""
    flight = problem.flights.flights[i]
    return np.concatenate(
        [np.full(len(flight.outputs[c].t), w) for c, w in zip(problem.channels, weights, strict=True)]
    )


def counts(problem: Problem) -> FloatArray:
    """Shape (channels,): samples of each channel over all manoeuvres."""
    return np.array(
        [sum(len(f.outputs[c].t) for f in problem.flights.flights) for c in problem.channels], float
    )
