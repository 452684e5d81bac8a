"""Filter error: the estimate in the air there is.

Output error takes every deviation for measurement noise. Moving air drives the aircraft, and its motion
remembers each gust. A Kalman filter of air and instruments (``innovations``) follows both. Filter and model
are linear about the fitted motion, so the filter whitens residuals and sensitivities alike, and the
estimate is least squares of the whitened ones (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle
System Identification*, chapter 5)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.model.response import N_PARAMETERS, N_SHARED, OUTPUTS, SHARED, Index, respond
from advisor.oem.covariance import Coloured as Noise
from advisor.oem.covariance import coloured, colours_of, influence, widening
from advisor.oem.innovations import AirModel, Gains, gains_of
from advisor.oem.instruments import Instrument, by_instruments
from advisor.oem.prior import precision
from advisor.oem.problem import Assembly, Problem, assemble
from advisor.oem.solution import Solution, contributions_of, reported
from advisor.oem.turbulence import Rows, Turbulence, find_turbulence

ROUNDS = 6
SETTLED = 0.1
"""Largest step still to take, in standard deviations, with which the estimate is settled."""
UNSETTLED = 3.0
"""... and with which the search has run away: the model does not hold for the record."""
MOST_MANEUVERS = 7
"""Newest manoeuvres from which the noise is found: its figures are known well enough by then."""
_UNIT = np.ones(len(OUTPUTS))
_STILL_M_S = 20.0
"""Air speed supposed where none was measured, to turn a gust's speed into an angle."""


@dataclass(frozen=True, slots=True)
class Place:
    """A setting of all parameters, with residuals and sensitivities there."""

    problem: Problem
    assembly: Assembly
    shared: FloatArray
    local: FloatArray
    residual: FloatArray
    """(N,)."""
    sensitivities: FloatArray
    """(N, 14)."""
    extra: FloatArray
    """(N, k) derivatives by the instrument parameters."""


@dataclass(frozen=True, slots=True)
class Whitened:
    """A place seen through the filter, the manoeuvres' own parameters eliminated."""

    cost: float
    """-2 log likelihood, but for a constant, with the prior's part."""
    step: FloatArray
    """(n,) of the shared and instrument parameters that are free."""
    own_steps: tuple[FloatArray, ...]
    """Of each manoeuvre's own parameters that are free."""
    std: FloatArray
    """(n,) Cramér-Rao standard deviations."""

    @property
    def pending(self) -> float:
        """The largest step still to take, in standard deviations."""
        return float(np.max(np.abs(self.step) / self.std))


def moving_air(solution: Solution, seen_by_alpha: bool) -> Turbulence:
    """Whether the residuals of a solution bear the mark of moving air, and the noise that fits best.

    Parameters
    ----------
    seen_by_alpha
        Whether the angle of attack reads the air, as a vane does, or is made from inertial sensors.
    """
    none = np.empty((len(solution.residual), 0))
    place = Place(
        solution.problem,
        solution.assembly,
        solution.optimum.shared,
        solution.optimum.local,
        solution.residual,
        solution.sensitivities,
        none,
    )
    rows = _rows(place)[-MOST_MANEUVERS:]
    white = np.array([_white(rows, c) for c in range(len(OUTPUTS))])
    return find_turbulence(rows, _system(place, 1.0)[:4], white, seen_by_alpha, start_variance=0.0)


def _white(rows: Sequence[Rows], channel: int) -> float:
    """Standard deviation of the white part of an output's residual, from its differences."""
    steps = np.concatenate([np.diff(r.left[r.channel == channel]) for r in rows])
    return float(np.median(np.abs(steps))) / 0.6745 / np.sqrt(2.0) if len(steps) else 1.0


def filter_error(solution: Solution, air: AirModel, instruments: Sequence[Instrument]) -> Solution | None:
    """The estimate with moving air and coloured instruments allowed for; None where the search runs away.

    Parameters
    ----------
    solution
        Where the search begins: an output error solution.
    air
        Noise of the instruments and motion of the air.
    instruments
        Parameters of the instruments that are estimated, too.

    Returns
    -------
    Solution or None
        ``theta``, ``covariance_cr`` and ``covariance`` are filter error's; residuals are the innovations'
        raw counterparts at the new place, and the cost is that of the new place.
    """
    optimum = solution.optimum
    here = _at(solution.problem, optimum.shared, optimum.local, instruments)
    seen = None if here is None else _whitened(here, air, len(instruments))
    if here is None or seen is None:
        return None
    for _ in range(ROUNDS):
        there, next_seen = _better(here, seen, air, instruments)
        if there is None or next_seen is None:
            break
        here, seen = there, next_seen
        if seen.pending < SETTLED:
            break
    return _solution(solution, here, air) if seen.pending < UNSETTLED else None


def _better(
    here: Place, seen: Whitened, air: AirModel, instruments: Sequence[Instrument]
) -> tuple[Place | None, Whitened | None]:
    """The likeliest place along the step; none where the likelihood falls all the way.

    A whole step ignores that the filter's gains move with the parameters, and overshoots in a curved valley.
    """
    best: tuple[Place | None, Whitened | None] = (None, None)
    lowest = seen.cost
    for scale in (1.0, 0.5, 0.25, 0.1, 0.03):
        there = _moved(here, seen, scale, instruments)
        found = None if there is None else _whitened(there, air, len(instruments))
        if found is not None and found.cost < lowest:
            best, lowest = (there, found), found.cost
        elif best[1] is not None:
            break
    return best


def _moved(here: Place, seen: Whitened, scale: float, instruments: Sequence[Instrument]) -> Place | None:
    """The place after a share of the step; None where the model overflows there."""
    common, own = _free(here.assembly)
    shared, local, problem = here.shared.copy(), here.local.copy(), here.problem
    shared[common] += scale * seen.step[: len(common)]
    for m, step in enumerate(seen.own_steps):
        local[m, own - N_SHARED] += scale * step
    for x, change in zip(instruments, seen.step[len(common) :], strict=True):
        problem = x.write(problem, float(np.clip(x.read(problem) + scale * change, x.lowest, x.highest)))
    return _at(problem, shared, local, instruments)


def _at(
    problem: Problem, shared: FloatArray, local: FloatArray, instruments: Sequence[Instrument]
) -> Place | None:
    assembly = assemble(problem)
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    if not respond(assembly.grid, shared, local, y, g):
        return None
    extra = by_instruments(problem, shared, local, instruments)
    return Place(problem, assembly, shared, local, assembly.z - y, g, extra)


def _free(assembly: Assembly) -> tuple[Index, Index]:
    """Free shared parameters and free parameters of each manoeuvre's own, as indices of all 14."""
    return assembly.free[assembly.free < N_SHARED], assembly.free[assembly.free >= N_SHARED]


def _in_time(assembly: Assembly, m: int) -> Index:
    """Rows of one manoeuvre in order of time."""
    rows = np.concatenate([np.arange(s.start, s.stop) for s in assembly.rows[m].values()])
    return np.asarray(rows[np.argsort(assembly.t[rows], kind="stable")])


def _speeds(place: Place) -> list[float]:
    speeds = [record.airspeed for record in place.problem.records]
    return [_STILL_M_S if speed is None else float(np.mean(speed.y)) for speed in speeds]


def _rows(place: Place) -> list[Rows]:
    found = []
    for m, speed in enumerate(_speeds(place)):
        order = _in_time(place.assembly, m)
        channel, left = place.assembly.channel[order], place.residual[order].copy()
        for c in np.unique(channel):
            left[channel == c] -= left[channel == c].mean()
        found.append(Rows(place.assembly.t[order], channel, left, speed))
    return found


def _system(place: Place, ratio: float) -> FloatArray:
    """Z_α, Z_q, M_α, M_q at an air speed of ``ratio`` times the reference."""
    z_a, z_q, m_a, m_q = (place.shared[SHARED.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    return np.array([ratio * z_a, z_q, ratio**2 * m_a, ratio * m_q])


def _gains(place: Place, air: AirModel) -> list[tuple[Index, Gains]]:
    """For each manoeuvre its rows in order of time, and the filter's gains along them."""
    problem, found = place.problem, []
    for m, speed in enumerate(_speeds(place)):
        system = np.append(_system(place, speed / (problem.reference_airspeed_m_s or speed)), speed)
        order = _in_time(place.assembly, m)
        arms = (problem.vane_arm_m, problem.accelerometer_arm_m)
        # The fit has initial states of its own, so the filter begins without any doubt about them.
        gains = gains_of(
            place.assembly.t[order], place.assembly.channel[order], system, air, 0.0, arms_m=arms
        )
        found.append((order, gains))
    return found


def _whitened(place: Place, air: AirModel, instruments: int) -> Whitened | None:
    common, own = _free(place.assembly)
    n = len(common) + instruments
    prior = precision(place.problem, place.shared)[common]
    information, gradient = np.zeros((n, n)), np.zeros(n)
    information[: len(common), : len(common)] = np.diag(prior)
    gradient[: len(common)] = -prior * place.shared[common]
    cost, parts = float(np.sum(prior * place.shared[common] ** 2)), []
    columns = np.column_stack([place.residual, place.sensitivities, place.extra])
    shared_columns = [*(1 + common), *range(1 + N_PARAMETERS, 1 + N_PARAMETERS + instruments)]
    for order, gains in _gains(place, air):
        white = gains.innovations(columns[order])
        left, mine = white[:, 0], white[:, shared_columns]
        basis, triangle = np.linalg.qr(white[:, 1 + own])
        kept, rest = mine - basis @ (basis.T @ mine), left - basis @ (basis.T @ left)
        information += kept.T @ kept
        gradient += kept.T @ rest
        cost += 2.0 * float(np.sum(np.log(gains.root))) + float(rest @ rest)
        parts.append((basis, triangle, mine, left))
    if not (np.all(np.isfinite(information)) and np.isfinite(cost)):
        return None
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    inverse = np.linalg.pinv(information / np.outer(scale, scale), rcond=1e-12, hermitian=True)
    step = (inverse @ (gradient / scale)) / scale
    own_steps = tuple(
        np.asarray(np.linalg.lstsq(triangle, basis.T @ (left - mine @ step), rcond=1e-10)[0])
        for basis, triangle, mine, left in parts
    )
    return Whitened(cost, step, own_steps, np.sqrt(np.diag(inverse)) / scale)


def _solution(start: Solution, place: Place, air: AirModel) -> Solution | None:
    """Errors of the place reached: Cramér-Rao's, and those that allow for colour left in the innovations."""
    assembly, n = place.assembly, len(PARAMETERS)
    white = np.empty((len(place.residual), 1 + N_PARAMETERS + place.extra.shape[1]))
    columns = np.column_stack([place.residual, place.sensitivities, place.extra])
    for order, gains in _gains(place, air):
        white[order] = gains.innovations(columns[order])
    g, extra = white[:, 1 : 1 + N_PARAMETERS], white[:, 1 + N_PARAMETERS :]
    effect = influence(assembly, g, _UNIT, extra, precision(place.problem, place.shared))
    if effect is None:
        return None
    colours = colours_of(assembly, white[:, 0], g)
    noise = Noise(colours, widening(assembly, effect.rows, colours))
    fitted = assembly.z - place.residual
    optimum = start.optimum._replace(
        shared=place.shared, local=place.local, fitted=fitted, sensitivities=place.sensitivities
    )
    return replace(
        start,
        problem=place.problem,
        assembly=assembly,
        optimum=optimum,
        influence=effect,
        theta=reported(place.shared, place.local),
        covariance_cr=effect.rows[:, :n].T @ effect.rows[:, :n],
        covariance=coloured(assembly, effect.rows, noise),
        noise=noise,
        contributions=contributions_of(assembly, effect.rows, white[:, 0]),
        extra=place.extra,
    )
