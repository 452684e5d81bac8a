"""Output error over several manoeuvres with any effects in the model: Gauss-Newton by blocks.

Shared numbers (derivatives, parameters of effects) are few; every manoeuvre adds its own initial
state, trim, offsets and uncertain edges of the command, which are eliminated manoeuvre by manoeuvre
(a Schur complement), so the cost is linear in manoeuvres. The noise of each channel is re-estimated
at every step, which minimises det R of Eqs. (7)-(8) for a diagonal R.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from advisor.flight.messages import FloatArray
from advisor.gap.data import Flight, Flights
from advisor.gap.layout import DERIVATIVES, INDEX, NUISANCES, OUTPUTS, SKEWS
from advisor.gap.simulate import DISTURB_INPUT, read_off, simulate, surface
from advisor.gap.variant import Variant

_NO_DISTURBANCE = np.zeros((4, 0))
_DERIVATIVE_STEP = 1e-3
_NUISANCE_STEPS = (1e-4, 1e-4)
_EDGE_VARIANCE = 1.0 / 12.0
"""An edge of a linear command lies anywhere between two stamps: uniform over the interval."""
_HELD_JITTER_S = 0.0015
"""A held command changes at its stamp, give or take the stamp's resolution."""


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

    @property
    def shared(self) -> FloatArray:
        """All shared numbers as one vector: derivatives, then parameters of effects."""
        return np.concatenate([self.derivatives, *self.values])

    def moved(self, shared: FloatArray, own: FloatArray) -> "Point":
        """The same model elsewhere."""
        values, at = [], len(DERIVATIVES)
        for effect in self.effects:
            values.append(shared[at : at + len(effect.names)])
            at += len(effect.names)
        return replace(self, derivatives=shared[: len(DERIVATIVES)], own=own, values=tuple(values))

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


@dataclass(frozen=True)
class Problem:
    """The data, the fixed part of the simulation, and how the command moved between its stamps."""

    flights: Flights
    base: FloatArray
    """Shape (entries,): what the aircraft file already has in it."""
    held: bool = False
    """Command held between stamps instead of linear."""
    smallest_noise: FloatArray | None = None
    """Shape (channels,): noise is never taken to be below this."""
    believed: FloatArray | None = None
    """Shape (6,): derivatives of the aircraft file, when it has all."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Outputs that are compared."""
        return self.flights.channels

    def driving(self, point: Point) -> FloatArray:
        """Shape (manoeuvres, entries): the numbers each manoeuvre is simulated with."""
        p = np.tile(self.base, (len(self.flights), 1))
        p[:, : len(DERIVATIVES)] = point.derivatives
        p[:, len(DERIVATIVES) : len(DERIVATIVES) + len(NUISANCES)] = point.own
        for effect, values in zip(point.effects, point.values, strict=True):
            if effect.sides is not None and point.sides is not None:
                p[:, INDEX[effect.sides[0]]] = point.sides
            effect.apply(p, values, self.flights)
        return p

    def fly(self, flight: Flight, p: FloatArray, disturbance: FloatArray = _NO_DISTURBANCE) -> FloatArray:
        """Simulated outputs of one manoeuvre on the grid, shape (4, n + 1)."""
        delta = surface(flight.h, flight.n, flight.t_u, flight.u, self.held, flight.u_trim, p)
        return simulate(flight.h, delta, flight.slow, disturbance, flight.trim, p)

    def read(self, flight: Flight, grid: FloatArray, p: FloatArray) -> FloatArray:
        """All channels at their own stamps, one after another."""
        return np.concatenate(
            [
                read_off(
                    grid[OUTPUTS.index(c)], flight.h, flight.outputs[c].t, p[INDEX[SKEWS[OUTPUTS.index(c)]]]
                )
                for c in self.channels
            ]
        )

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

    def parts(self, i: int, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Measured minus simulated of manoeuvre ``i``, shape (rows,), and the simulation on its grid."""
        flight = self.flights.flights[i]
        grid = self.fly(flight, p)
        return self.measured(flight) - self.read(flight, grid, p), grid


@dataclass
class Linear:
    """The model of one manoeuvre made linear about a point, before weighting."""

    left: FloatArray
    """Shape (rows,): measured minus simulated."""
    shared: FloatArray
    """Shape (rows, k)."""
    own: FloatArray
    """Shape (rows, m): initial states, trim, offsets (flat priors), then edges and air."""
    prior: FloatArray
    """Shape (m,): inverse prior variances, 0 for flat."""


@dataclass(frozen=True)
class Fitted:
    """Where the search ended."""

    point: Point
    noise: FloatArray
    """Shape (channels,): standard deviation of what is left."""
    cost: float
    """-2 log likelihood, profiled over the noise, priors included."""
    left: tuple[FloatArray, ...]
    """Per manoeuvre, stacked residuals after offsets, edges and air."""
    information: FloatArray
    """Shape (k, k): of the shared numbers, own numbers eliminated."""
    linear: tuple[Linear, ...]
    iterations: int


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
        jitter = (_HELD_JITTER_S / flight.edges[:, 2]) ** 2
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
    """The same response, starting later."""
    k = max(round(at / h), 0)
    out = np.zeros_like(pulse)
    if k < pulse.shape[1]:
        out[:, k:] = pulse[:, : pulse.shape[1] - k]
    return out


def row_weights(problem: Problem, i: int, weights: FloatArray) -> FloatArray:
    """One weight a row of manoeuvre ``i``."""
    flight = problem.flights.flights[i]
    return np.concatenate(
        [np.full(len(flight.outputs[c].t), w) for c, w in zip(problem.channels, weights, strict=True)]
    )


def factor(
    problem: Problem, i: int, own: FloatArray, prior: FloatArray, weights: FloatArray
) -> tuple[FloatArray, bool]:
    """Cholesky factor of AᵀWA + Λ⁻¹ for one manoeuvre's own columns."""
    weighted = own * row_weights(problem, i, weights)[:, None]
    normal = weighted.T @ weighted + np.diag(prior)
    normal[np.diag_indices_from(normal)] *= 1.0 + 1e-10
    normal[np.diag_indices_from(normal)] += 1e-12 * np.trace(normal) / len(normal)
    return cho_factor(normal, lower=True)


def solve_blocks(
    problem: Problem, linear: Sequence[Linear], weights: FloatArray, damping: float
) -> tuple[FloatArray, list[FloatArray], FloatArray, list[FloatArray]]:
    """One Gauss-Newton step.

    Returns
    -------
    Step of the shared numbers (k,), per manoeuvre the own numbers' solution (m,), the information
    matrix (k, k), and per manoeuvre the predicted residual after the step.
    """
    k = linear[0].shared.shape[1]
    H, g = np.zeros((k, k)), np.zeros(k)
    kept = []
    for i, block in enumerate(linear):
        w = row_weights(problem, i, weights)
        A, J, r = block.own * w[:, None], block.shared * w[:, None], block.left * w
        chol = factor(problem, i, block.own, block.prior, weights)
        AJ, Ar = A.T @ J, A.T @ r
        solved = cho_solve(chol, np.column_stack([AJ, Ar]))
        H += J.T @ J - AJ.T @ solved[:, :k]
        g += J.T @ r - AJ.T @ solved[:, k]
        kept.append(solved)
    scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
    normal = H / np.outer(scale, scale)
    step = np.linalg.lstsq(normal + damping * np.eye(k), g / scale, rcond=1e-12)[0] / scale
    owns, lefts = [], []
    for block, solved in zip(linear, kept, strict=True):
        own = solved[:, k] - solved[:, :k] @ step
        owns.append(own)
        lefts.append(block.left - block.shared @ step - block.own @ own)
    return step, owns, H, lefts


def linearise(problem: Problem, point: Point) -> tuple[Linear, ...]:
    """The whole model made linear about a point."""
    p = problem.driving(point)
    lefts, grids = zip(*[problem.parts(i, p[i]) for i in range(len(problem.flights))], strict=True)
    shared = shared_columns(problem, point, p, grids, range(len(point.shared)))
    blocks = []
    for i in range(len(problem.flights)):
        own, prior = own_columns(problem, i, p[i], grids[i])
        blocks.append(Linear(lefts[i], shared[i], own, prior))
    return tuple(blocks)


def noise_of(problem: Problem, lefts: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,): RMS of what is left, not below the smallest noise."""
    power, count = np.zeros(len(problem.channels)), np.zeros(len(problem.channels))
    for flight, left in zip(problem.flights.flights, lefts, strict=True):
        for c, rows in enumerate(problem.rows(flight)):
            power[c] += float(left[rows] @ left[rows])
            count[c] += rows.stop - rows.start
    noise = np.sqrt(power / np.maximum(count, 1.0))
    return np.maximum(noise, 1e-7 if problem.smallest_noise is None else problem.smallest_noise)


def counts(problem: Problem) -> FloatArray:
    """Shape (channels,): samples of each channel over all manoeuvres."""
    return np.array(
        [sum(len(f.outputs[c].t) for f in problem.flights.flights) for c in problem.channels], float
    )


def cost_of(
    problem: Problem, lefts: Sequence[FloatArray], owns: Sequence[FloatArray], linear: Sequence[Linear]
) -> float:
    """-2 log likelihood profiled over the noise: Σ_c N_c log σ_c², plus the priors on edges and air."""
    noise = noise_of(problem, lefts)
    power = sum(float(np.sum(b.prior * o**2)) for b, o in zip(linear, owns, strict=True))
    return float(np.sum(counts(problem) * 2.0 * np.log(noise))) + power


def fit(
    problem: Problem,
    start: Point,
    noise: FloatArray | None = None,
    iterations: int = 12,
    tolerance: float = 0.02,
) -> Fitted:
    """Minimise det R from a start. The first noise decides the weights of the first step."""
    point = start
    linear = linearise(problem, point)
    weights = 1.0 / (noise_of(problem, [b.left for b in linear]) if noise is None else noise)
    lower, upper = bounds_of(point)
    damping, best = 0.0, np.inf
    information = np.eye(len(point.shared))
    lefts: list[FloatArray] = [b.left for b in linear]
    done = 0
    kept: tuple[Point, tuple[Linear, ...]] = (point, linear)
    while done < iterations:
        done += 1
        # Weights and own numbers settle together at a fixed linearisation: cheap, no simulation.
        for _ in range(4):
            step, owns, information, lefts = solve_blocks(problem, linear, weights, damping)
            weights = 1.0 / noise_of(problem, lefts)
        owns_here, left_here = own_only(problem, linear, weights)
        here = cost_of(problem, left_here, owns_here, linear)
        if here < best + 1e-9:
            gained = best - here
            best, kept = here, (point, linear)
            damping = damping / 10.0 if damping > 1e-6 else 0.0
            if gained < tolerance:
                break
        else:
            damping = max(10.0 * damping, 1e-3)
            point, linear = kept
            if damping > 1e3:
                break
            step, owns, information, lefts = solve_blocks(problem, linear, weights, damping)
        shared = np.clip(point.shared + step, lower, upper)
        own = point.own + np.array([o[: len(NUISANCES)] for o in owns])
        point = point.moved(shared, own)
        linear = linearise(problem, point)
    point, linear = kept
    owns_here, left_here = own_only(problem, linear, weights)
    _, _, information, _ = solve_blocks(problem, linear, 1.0 / noise_of(problem, left_here), 0.0)
    return Fitted(point, noise_of(problem, left_here), best, tuple(left_here), information, linear, done)


def own_only(
    problem: Problem, linear: Sequence[Linear], weights: FloatArray
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Own numbers and residuals of every manoeuvre at fixed shared numbers."""
    owns, lefts = [], []
    for i, block in enumerate(linear):
        w = row_weights(problem, i, weights)
        chol = factor(problem, i, block.own, block.prior, weights)
        own = cho_solve(chol, (block.own * w[:, None]).T @ (block.left * w))
        owns.append(own)
        lefts.append(block.left - block.own @ own)
    return owns, lefts


def bounds_of(point: Point) -> tuple[FloatArray, FloatArray]:
    """Lower and upper bounds of the shared numbers."""
    free = np.full(len(point.derivatives), np.inf)
    lower = np.concatenate([-free, *[np.array([b[0] for b in e.bounds]) for e in point.effects]])
    upper = np.concatenate([free, *[np.array([b[1] for b in e.bounds]) for e in point.effects]])
    return lower, upper


def evidence_of(problem: Problem, fitted: Fitted) -> float:
    """-2 log marginal likelihood, up to what two ways of reading the command have in common.

    The cost, plus the price of the edges' freedom: log det(I + Λ A_eᵀ W A_e), flat numbers eliminated.
    """
    total = fitted.cost
    for i, block in enumerate(fitted.linear):
        w = row_weights(problem, i, 1.0 / fitted.noise)[:, None]
        free = block.prior == 0.0
        if np.all(free):
            continue
        flat, edges = block.own[:, free] * w, block.own[:, ~free] * w
        q = np.linalg.qr(flat)[0]
        left = (edges - q @ (q.T @ edges)) / np.sqrt(block.prior[~free])
        total += float(np.linalg.slogdet(np.eye(left.shape[1]) + left.T @ left)[1])
    return total
