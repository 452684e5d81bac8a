"""Estimation of a motion that unknown forces drive, for every axis.

Output error treats every deviation as noise of an instrument. Gusts, propeller and vibration drive the
aircraft itself, and the motion after such a force depends on the force. Here white noise drives the rate of
every state that has a force, and a gust adds its angle to the angle of incidence. The instruments have white
and coloured noise. A Kalman filter about the fitted motion whitens residuals and sensitivities. The estimate
is least squares of the whitened residuals (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle
System Identification*, chapter 5).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from advisor.flight.signals.robust import robust_std
from advisor.model.response import Index
from advisor.oem.arrow import inverse_of
from advisor.oem.coordinate_search import coordinate_search
from advisor.oem.descent import Motion
from advisor.oem.driven_kernel import driven_filter
from advisor.oem.evaluation import errors_of
from advisor.oem.extra import Extra, Parameter, moved_by
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.oem.solution import Solution, reported
from advisor.oem.weighing import Weighing
from advisor.process.arrays import FloatArray

ROUNDS = 8
"""Numerical: largest number of noise estimates, each followed by one step of all parameters."""
SETTLED = 0.1
"""Largest pending step of a converged estimate, in standard deviations."""
UNSETTLED = 3.0
"""Pending step, in standard deviations, above which the search counts as diverged."""
MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""
LEAST_GUST_RAD = 0.0017
"""Least standard deviation of a reported gust angle, rad: 0.1 deg."""
SCALE = 0.03 / 3.0**0.5
"""Standard deviation of the scale of an instrument, relative. Data sheets of autopilots' gyros and
accelerometers allow 3 % to either side. Residuals show a part of it, and the derivatives absorb the rest."""
STAMP_S = 1e-3 / 12.0**0.5
"""Standard deviation of a stamp in whole milliseconds, s."""
CLEARLY = 20.0
"""Log likelihood gain of a driven motion over coloured instruments, nats, above which the motion counts as
driven."""
_STEPS = (1.0, 0.5, 0.2)
"""Numerical: steps of the first noise search in the logarithms of the noise parameters."""
_FINE = (0.2,)
"""Numerical: steps of a noise search that goes on from another one."""
_RANGE = (1e-12, 1e3)
"""Range of every noise parameter, SI. Without a lower bound the likelihood of data without noise has no
maximum."""
_MEMORY_S, _GUST_MEMORY_S = (0.05, 5.0), (0.5, 5.0)
"""Ranges of the correlation times of coloured noise and of gusts, s. Dryden's lengths are 20 to 600 m near
the ground, and aircraft pass them at 20 to 130 m/s."""
_GRID_S = 1e-4
"""Numerical: grid of the time steps, s, of which equal ones share their matrices. Residuals hardly move in
half of it."""
_MOST = 0.1
"""Numerical: largest start of an intensity's root, which a state that no output shows begins with, SI."""
_SCALES = (1.0, 0.5, 0.25, 0.1, 0.03)


class Linear(NamedTuple):
    """Motion near a fitted one, of s states and o outputs."""

    matrix: FloatArray
    """Shape (s, s): rates of the states by the states."""
    seen: FloatArray
    """Shape (o, s): outputs by the states."""
    air: FloatArray
    """Shape (s,): rates of the states by the gust's angle of incidence, 1/s."""
    air_seen: FloatArray
    """Shape (o,): outputs by the gust's angle of incidence."""
    forced: Index
    """Indices of the states whose rates contain a force."""


class DrivenMotion(Motion, Protocol):
    """Interface of an axis whose motion unknown forces drive."""

    def linear(self, problem: Any, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` at its mean air speed."""

    def unsure(self, laid: Any, y: FloatArray, /) -> FloatArray:
        """Return the change (N, k) of the outputs ``y`` by a standard deviation of each instrument quantity
        that is not estimated."""


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of the instruments and forces on the motion, as standard deviations and intensities, SI."""

    white: FloatArray
    """Shape (o,): white noise of each output."""
    coloured: FloatArray
    """Shape (o,): coloured noise of each output."""
    memory_s: float
    """Correlation time of the coloured noise, s."""
    drive: FloatArray
    """Shape (f,): square root of the intensity of the white noise on each forced rate."""
    gust: float
    """Standard deviation of the gust's angle of incidence, rad."""
    gust_memory_s: float
    """Correlation time of the gust's angle, s."""

    @property
    def logarithms(self) -> FloatArray:
        """Shape (2·o + f + 3,): logarithms of all parameters."""
        every = [*self.white, *self.coloured, *self.drive, self.gust, self.memory_s, self.gust_memory_s]
        return np.asarray(np.log(np.clip(every, *_RANGE)))

    def at(self, logarithms: FloatArray) -> "Noise":
        """Return the noise with other parameters, each within its range."""
        o, values = len(self.white), np.clip(np.exp(logarithms), *_RANGE)
        return Noise(
            values[:o],
            values[o : 2 * o],
            float(np.clip(values[-2], *_MEMORY_S)),
            values[2 * o : -3],
            float(values[-3]),
            float(np.clip(values[-1], *_GUST_MEMORY_S)),
        )


@dataclass(frozen=True, slots=True)
class _Place:
    """One setting of all parameters, with its residuals, sensitivities and linear motions."""

    problem: Any
    assembly: Laid
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    sensitivities: FloatArray
    extra: Extra
    motions: Sequence[Linear]
    orders: Sequence[Index]
    """Rows of each manoeuvre in order of time."""
    steps: Sequence[tuple[FloatArray, Index, Index]]
    """Distinct lengths of each manoeuvre's time steps, s, and two indices of each row in order of time. They
    are those of the step before the row, and of the row's output in ``there``."""
    there: Index
    """Indices of the measured outputs."""
    floor: FloatArray
    """Shape (o,): least white noise of each output."""

    @property
    def columns(self) -> FloatArray:
        """Shape (N, k): residual, sensitivities to each manoeuvre's parameters and to the common ones, and to
        servos and clocks."""
        own, common = self.sensitivities[:, self.assembly.own], self.sensitivities[:, self.assembly.common]
        return np.column_stack([self.residual, own, common, self.extra.columns])

    def whitened(self, columns: FloatArray, noise: Noise, newest: int = 0) -> tuple[FloatArray, float]:
        """Return the whitened ``columns`` (N, k) and the log determinant, of the ``newest`` manoeuvres or of
        all. Rows of other manoeuvres stay zero."""
        white, volume = np.zeros(columns.shape), 0.0
        there = self.there
        instruments = np.maximum(noise.white, self.floor)[there], noise.coloured[there], noise.memory_s
        for motion, order, steps in list(zip(self.motions, self.orders, self.steps, strict=True))[-newest:]:
            s = len(motion.matrix)
            matrix = np.zeros((s + 1, s + 1))
            matrix[:s, :s], matrix[:s, s], matrix[s, s] = (
                motion.matrix,
                motion.air,
                -1.0 / noise.gust_memory_s,
            )
            begun, drive = np.zeros(s + 1), np.zeros(s + 1)
            begun[s], drive[s] = noise.gust**2, 2.0 * noise.gust**2 / noise.gust_memory_s
            drive[motion.forced] = noise.drive**2
            white[order], own = driven_filter(
                *steps,
                matrix,
                np.column_stack([motion.seen, motion.air_seen])[there],
                begun,
                drive,
                *instruments,
                np.ascontiguousarray(columns[order]),
            )
            volume += own
        return white, volume

    def cost(self, noise: Noise, newest: int = 0) -> float:
        """Return -2 log likelihood of the residual, up to a constant."""
        white, volume = self.whitened(self.residual[:, None], noise, newest)
        return volume + float(np.sum(white**2))


class Driven(NamedTuple):
    """An estimate with unknown forces."""

    solution: Solution
    """Values and errors; the fit and the noise of the outputs are those at the new values."""
    noise: Noise
    gain: float
    """Log likelihood gain of the driven motion over coloured instruments, nats."""

    @property
    def gust_rad(self) -> float | None:
        """Standard deviation of the gust's angle, rad; None below ``LEAST_GUST_RAD``."""
        return self.noise.gust if self.noise.gust > LEAST_GUST_RAD else None


def driven(
    start: Solution,
    motion: DrivenMotion,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
) -> Driven | None:
    """Return the estimate with unknown forces; None if the motion is not driven, or if the search diverges.

    Parameters
    ----------
    start
        Output-error solution, from which the search starts.
    parameters
        Servos and clocks that are estimated with the derivatives.
    priors
        Function that returns the priors of the derivatives for a problem and shared parameters.
    """
    weighing = Weighing.by(start.noise.colours, start.assembly)
    coloured = weighing.volume + float(np.sum(weighing.forward(start.residual[:, None]) ** 2))
    if not 0.5 * (_cost_in_white_noise(start) - coloured) > CLEARLY:
        # The motion after a force is coloured: where no residual is, there is no force.
        return None
    here = _at(motion, start.problem, start.optimum.shared, start.optimum.local, parameters)
    if here is None:
        return None
    prior = priors(here.problem, here.shared)
    still = weighing.volume + _System.of(here, weighing.forward(here.columns), prior).misfit
    begun = [_likeliest(here, noise, _STEPS[:1]) for noise in _begun(here)]
    noise = _likeliest(here, begun[np.argmin([here.cost(one, MOST_MANEUVERS) for one in begun])], _STEPS[1:])
    white, volume = here.whitened(here.columns, noise)
    gain = 0.5 * (still - volume - _System.of(here, white, prior).misfit)
    if not gain > CLEARLY:
        return None
    pending = np.inf
    for _ in range(ROUNDS):
        there, pending = _stepped(motion, here, noise, parameters, priors)
        if there is None or pending < SETTLED:
            break
        here = there
        noise = _likeliest(here, noise, _FINE)
    if not pending < UNSETTLED:
        return None
    found = _solution(motion, start, here, noise, parameters, priors)
    return None if found is None else Driven(found, noise, gain)


def _at(
    motion: DrivenMotion,
    problem: Any,
    shared: FloatArray,
    local: FloatArray,
    parameters: Sequence[Parameter],
) -> _Place | None:
    """Return a setting of all parameters; None on numerical overflow."""
    laid = motion.laid(problem)
    found = motion.respond(problem, laid, shared, local, parameters)
    if found is None:
        return None
    there = np.unique(laid.channel)
    orders = [rows.start + np.argsort(laid.t[rows], kind="stable") for rows in laid.blocks]
    return _Place(
        problem,
        laid,
        shared,
        local,
        laid.z - found.y,
        found.g,
        Extra.of(found.columns(), problem, parameters),
        [motion.linear(problem, shared, m) for m in range(laid.maneuvers)],
        orders,
        [(*_distinct(laid.t[order]), np.searchsorted(there, laid.channel[order])) for order in orders],
        there,
        _floor(laid, found.y),
    )


def _floor(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the least white noise of each output, shape (o,): its change within the error of a stamp."""
    floor = np.full(len(laid.names.outputs), _RANGE[0])
    for c in np.unique(laid.channel):
        parts = [rows for named in laid.rows if (rows := named.get(laid.names.outputs[c])) is not None]
        pace = np.concatenate(
            [np.diff(y[rows]) / np.maximum(np.diff(laid.t[rows]), STAMP_S) for rows in parts]
        )
        floor[c] = max(floor[c], STAMP_S * float(np.sqrt(np.mean(pace**2))) if len(pace) else 0.0)
    return floor


def _distinct(t: FloatArray) -> tuple[FloatArray, Index]:
    """Return the distinct lengths (u,) of the steps between times, and the index (n,) of the step before each
    time."""
    lengths, kind = np.unique(np.rint(np.diff(t, prepend=t[0]) / _GRID_S), return_inverse=True)
    return lengths * _GRID_S, kind.astype(np.int64)


def _cost_in_white_noise(start: Solution) -> float:
    """Return -2 log likelihood of the residual in white noise of the likeliest size, up to a constant."""
    channel = start.assembly.channel
    counts, squares = np.bincount(channel), np.bincount(channel, start.residual**2)
    return float(np.sum(counts * (1.0 + np.log(np.maximum(squares, 1e-300) / np.maximum(counts, 1)))))


def _begun(place: _Place) -> Iterator[Noise]:
    """Yield the starts of the noise search: one with large jolts, and one with large gusts.

    The white noise is that of the residuals' differences.
    """
    channel, outputs = place.assembly.channel, len(place.assembly.names.outputs)
    white, size = np.ones(outputs), np.ones(outputs)
    for c in np.unique(channel):
        parts = [place.residual[rows][channel[rows] == c] for rows in place.assembly.blocks]
        size[c] = max(
            float(np.std(np.concatenate([part - part.mean() for part in parts if len(part)]))), 1e-9
        )
        white[c] = robust_std(np.concatenate([np.diff(part) for part in parts])) / 2.0**0.5
    seen, forced = np.abs(place.motions[0].seen), place.motions[0].forced
    there = np.isin(np.arange(outputs), channel)
    sizes = size[there, None] / np.maximum(seen[there][:, forced], 1e-9)
    moved = np.min(sizes, axis=0, initial=_MOST)
    white = np.clip(white, 1e-3 * size, size)
    for jolts, gusts in ((1.0, 0.1), (0.1, 1.0)):
        yield Noise(white, 0.5 * size, 0.3, jolts * moved, gusts * float(moved[0]), 1.0)


def _likeliest(place: _Place, noise: Noise, steps: Sequence[float]) -> Noise:
    """Return the likeliest noise, by a coordinate search in the logarithms with decreasing steps."""
    outputs = len(noise.white)
    free = [*place.there, *(outputs + place.there), *range(2 * outputs, len(noise.logarithms))]
    x, _ = coordinate_search(lambda y: place.cost(noise.at(y), MOST_MANEUVERS), noise.logarithms, free, steps)
    return noise.at(x)


class _System(NamedTuple):
    """Normal equations of the whitened rows, without each manoeuvre's own parameters."""

    information: FloatArray
    gradient: FloatArray
    own: Sequence[tuple[FloatArray, FloatArray, FloatArray, FloatArray]]
    """Basis and triangle of each manoeuvre's own columns, its common columns and its residual."""
    misfit: float
    """Sum of squares after a step of all parameters, up to a constant."""

    @classmethod
    def of(cls, place: _Place, white: FloatArray, prior: Priors, further: int = 0) -> "_System":
        """Return the normal equations of the whitened ``columns`` of a place.

        The columns of so many ``further`` parameters follow, each with a prior of mean 0 and deviation 1.
        """
        laid, extra = place.assembly, place.extra
        common, own = laid.common, laid.own
        known = (prior.std**-2)[common]
        information = np.diag(np.concatenate([known, extra.weight**2, np.ones(further)]))
        towards = known * (prior.mean - place.shared)[common]
        gradient = np.concatenate([towards, extra.weight * extra.pull, np.zeros(further)])
        parts, misfit = [], 0.0
        for rows in laid.blocks:
            residual, columns = white[rows, 0], white[rows, 1 + len(own) :]
            basis, triangle = np.linalg.qr(white[rows, 1 : 1 + len(own)])
            kept = columns - basis @ (basis.T @ columns)
            information += kept.T @ kept
            gradient += kept.T @ residual
            misfit += float(np.sum(residual**2) - np.sum((basis.T @ residual) ** 2))
            parts.append((basis, triangle, columns, residual))
        return cls(
            information, gradient, parts, misfit - float(gradient @ inverse_of(information)[0] @ gradient)
        )

    def step(self, held: dict[int, float]) -> FloatArray:
        """Return the step of the common parameters, with those in ``held`` moved by given amounts."""
        step = np.zeros(len(self.gradient))
        step[list(held)] = list(held.values())
        free = np.array([i for i in range(len(step)) if i not in held], np.int64)
        inverse, _ = inverse_of(self.information[np.ix_(free, free)])
        step[free] = inverse @ (self.gradient - self.information @ step)[free]
        return step


def _stepped(
    motion: DrivenMotion,
    here: _Place,
    noise: Noise,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
) -> tuple[_Place | None, float]:
    """Return the likeliest place along the step, and the step's length in standard deviations.

    The place is None if the likelihood decreases along the whole step. A full step ignores that the filter
    changes with the parameters, and overshoots in curved valleys. A parameter that would leave its range
    stops at the range's end, and the others are solved again.
    """
    prior = priors(here.problem, here.shared)
    system = _System.of(here, here.whitened(here.columns, noise)[0], prior)
    if not np.all(np.isfinite(system.information)):
        return None, np.inf
    common, own = here.assembly.common, here.assembly.own
    held: dict[int, float] = {}
    step = system.step(held)
    for _ in parameters:
        wanted = step[len(common) :]
        moved = moved_by(wanted, here.problem, parameters)
        allowed = np.array([x.read(moved) - x.read(here.problem) for x in parameters])
        ends = np.flatnonzero(~np.isclose(allowed, wanted, rtol=1e-6, atol=1e-12))
        if not len(ends):
            break
        held |= {len(common) + int(j): float(allowed[j]) for j in ends}
        step = system.step(held)
    std = np.sqrt(np.maximum(np.diag(inverse_of(system.information)[0]), 1e-300))
    pending = float(np.max(np.abs(step) / std))
    owns = [
        np.linalg.lstsq(triangle, basis.T @ (residual - columns @ step), rcond=1e-10)[0]
        for basis, triangle, columns, residual in system.own
    ]

    def cost(place: _Place) -> float:
        apart = (place.shared - prior.mean)[common] / prior.std[common]
        return place.cost(noise) + place.extra.penalty + float(apart @ apart)

    best, lowest = None, cost(here)
    for scale in _SCALES:
        shared, local = here.shared.copy(), here.local.copy()
        shared[common] += scale * step[: len(common)]
        local[:, own - len(here.assembly.names.shared)] += scale * np.array(owns)
        problem = moved_by(scale * step[len(common) :], here.problem, parameters)
        there = _at(motion, problem, shared, local, parameters)
        found = np.inf if there is None else cost(there)
        if found < lowest:
            best, lowest = there, found
        elif best is not None:
            break
    return best, pending


def _scaled(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the change (N, o) of the outputs ``y`` by a standard deviation of each output's scale."""
    columns = np.zeros((len(y), len(laid.names.outputs)))
    for named in laid.rows:
        for name, rows in named.items():
            columns[rows, laid.names.outputs.index(name)] = SCALE * (y[rows] - y[rows].mean())
    return columns


def _solution(
    motion: DrivenMotion,
    start: Solution,
    place: _Place,
    noise: Noise,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
) -> Solution | None:
    """Return the solution at the place, with Cramér-Rao errors and errors for coloured innovations."""
    laid, fitted = place.assembly, place.assembly.z - place.residual
    unsure = np.column_stack([motion.unsure(laid, fitted), _scaled(laid, fitted)])
    white, _ = place.whitened(
        np.column_stack([place.residual, place.sensitivities, place.extra.columns, unsure]), noise
    )
    size, split = unsure.shape[1], 1 + place.sensitivities.shape[1]
    left, g, extra, unsure = np.split(white, [1, split, white.shape[1] - size], axis=1)
    prior = priors(place.problem, place.shared)
    errors = errors_of(
        laid,
        left[:, 0],
        g,
        np.ones(len(laid.names.outputs)),
        place.extra.whitened(extra),
        np.asarray(prior.std**-2.0),
        prior_share=1.0,
    )
    if errors is None:
        return None
    # The estimate keeps the scales at 1: their posterior second moment is the error.
    ordered = np.column_stack([left, g[:, laid.own], g[:, laid.common], extra, unsure])
    system = _System.of(place, ordered, prior, size)
    shown = system.step({})[-size:]
    moment = inverse_of(system.information)[0][-size:, -size:] + np.outer(shown, shown)
    pulled = errors["influence"].rows.T @ unsure
    # Dynamics that the model lacks do not stand out in innovations: their error is that of output error.
    systematic, kept = pulled @ moment @ pulled.T, min(len(pulled), len(start.systematic))
    systematic[:kept, :kept] += start.systematic[:kept, :kept]
    errors["systematic"] = systematic
    optimum = start.optimum._replace(
        shared=place.shared,
        local=place.local,
        fitted=fitted,
        sensitivities=place.sensitivities,
    )
    return replace(
        start,
        problem=place.problem,
        assembly=laid,
        optimum=optimum,
        theta=reported(place.shared, place.local, laid.names),
        extra=place.extra,
        parameters=parameters,
        modes=None,
        profile=None,
        **errors,
    )
