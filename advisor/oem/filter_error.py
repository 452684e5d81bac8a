"""Filter error: parameter estimation in moving air.

Output error treats every deviation as measurement noise. Moving air drives the aircraft, so the motion after
a gust depends on the gust. A Kalman filter models moving air and coloured instruments (``innovations``).
Filter and model are linear about the fitted motion, so the filter whitens residuals and sensitivities. The
estimate is least squares of the whitened residuals (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle
System Identification*, chapter 5).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.signals.robust import robust_std
from advisor.model.outputs import N_PARAMETERS, N_SHARED, OUTPUTS
from advisor.oem.evaluation import errors_of
from advisor.oem.extra import moved_by
from advisor.oem.innovations import AirModel
from advisor.oem.instruments import Instrument
from advisor.oem.prior import precision
from advisor.oem.solution import Solution, reported
from advisor.oem.turbulence import Rows, Turbulence, find_turbulence
from advisor.oem.whitened import (
    Linearization,
    Whitened,
    at,
    gains_along,
    in_time,
    speeds_of,
    system_of,
    whitened,
)

ROUNDS = 6
SETTLED = 0.1
"""Largest pending step of a converged estimate, in standard deviations."""
UNSETTLED = 3.0
"""Pending step, in standard deviations, above which the search counts as diverged."""
MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""
_UNIT = np.ones(len(OUTPUTS))


def moving_air(solution: Solution, seen_by_alpha: bool) -> Turbulence:
    """Return the moving air and the noise that fit a solution's residuals best; None for still air.

    Parameters
    ----------
    seen_by_alpha
        Whether a vane measures the angle of attack, instead of inertial sensors.
    """
    rows = _rows(solution)[-MOST_MANEUVERS:]
    white = np.array([_white(rows, c) for c in range(len(OUTPUTS))])
    system = system_of(solution.optimum.shared, 1.0)
    return find_turbulence(rows, system, white, seen_by_alpha, start_variance=0.0)


def _white(rows: Sequence[Rows], channel: int) -> float:
    """Return the standard deviation of the residual's white part in one output, from its differences."""
    steps = np.concatenate([np.diff(r.residual[r.channel == channel]) for r in rows])
    return robust_std(steps) / float(np.sqrt(2.0)) if len(steps) else 1.0


def _rows(solution: Solution) -> list[Rows]:
    found = []
    for m, speed in enumerate(speeds_of(solution.problem)):
        order = in_time(solution.assembly, m)
        channel, residual = solution.assembly.channel[order], solution.residual[order]
        for c in np.unique(channel):
            residual[channel == c] -= residual[channel == c].mean()
        found.append(Rows(solution.assembly.t[order], channel, residual, speed))
    return found


def filter_error(solution: Solution, air: AirModel, instruments: Sequence[Instrument]) -> Solution | None:
    """Return the estimate with moving air and coloured instruments; None where the search diverges.

    Parameters
    ----------
    solution
        Output error solution from which the search starts.
    air
        Noise of the instruments, and motion of the air.
    instruments
        Instrument parameters that are also estimated.

    Returns
    -------
    Solution or None
        ``theta``, ``covariance_cr`` and ``covariance`` come from filter error. Residuals and cost are those
        of output error at the new parameter values.
    """
    optimum = solution.optimum
    here = at(solution.problem, optimum.shared, optimum.local, instruments)
    seen = None if here is None else whitened(here, air)
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
    here: Linearization, seen: Whitened, air: AirModel, instruments: Sequence[Instrument]
) -> tuple[Linearization | None, Whitened | None]:
    """Return the likeliest point along the step; None if the likelihood decreases along the whole step.

    A full step ignores that the filter gains change with the parameters, and overshoots in curved valleys.
    """
    best: tuple[Linearization | None, Whitened | None] = (None, None)
    lowest = seen.cost
    for scale in (1.0, 0.5, 0.25, 0.1, 0.03):
        there = _moved(here, seen, scale, instruments)
        found = None if there is None else whitened(there, air)
        if found is not None and found.cost < lowest:
            best, lowest = (there, found), found.cost
        elif best[1] is not None:
            break
    return best


def _moved(
    here: Linearization, seen: Whitened, scale: float, instruments: Sequence[Instrument]
) -> Linearization | None:
    """Return the point after a share of the step; None on numerical overflow of the model."""
    common, own = here.assembly.common, here.assembly.own
    shared, local = here.shared.copy(), here.local.copy()
    shared[common] += scale * seen.step[: len(common)]
    for m, step in enumerate(seen.own_steps):
        local[m, own - N_SHARED] += scale * step
    problem = moved_by(scale * seen.step[len(common) :], here.problem, instruments)
    return at(problem, shared, local, instruments)


def _solution(start: Solution, place: Linearization, air: AirModel) -> Solution | None:
    """Return the solution at the point, with Cramér-Rao errors and errors for coloured innovations."""
    assembly = place.assembly
    white = np.empty((len(place.residual), 1 + N_PARAMETERS + len(place.extra)))
    columns = np.column_stack([place.residual, place.sensitivities, place.extra.columns])
    for order, gains in gains_along(place, air):
        white[order] = gains.innovations(columns[order])
    g, extra = white[:, 1 : 1 + N_PARAMETERS], place.extra.whitened(white[:, 1 + N_PARAMETERS :])
    prior = precision(place.problem, place.shared)
    errors = errors_of(assembly, white[:, 0], g, _UNIT, extra, prior)
    if errors is None:
        return None
    fitted = assembly.z - place.residual
    optimum = start.optimum._replace(
        shared=place.shared, local=place.local, fitted=fitted, sensitivities=place.sensitivities
    )
    return replace(
        start,
        problem=place.problem,
        assembly=assembly,
        optimum=optimum,
        theta=reported(place.shared, place.local),
        extra=place.extra,
        **errors,
    )
