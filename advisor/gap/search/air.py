"""Is the air moving? Turbulence and gusts, told from coloured instrument noise by their pattern.

A gust enters the vane, the lift and the moment at once; noise of instruments, however coloured, does
not. Judged by the Kalman likelihood of ``advisor.oem.turbulence``; the course of the gust itself comes
from the probe of the air.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.flight.robust import robust_std
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import KNOTS_S, Course, disturbance_courses
from advisor.gap.noise.quiet import ANY_GUST, instrument_noise, rows_of, system_of, with_floor
from advisor.model.response import OUTPUTS
from advisor.oem.turbulence import Turbulence, find_turbulence

AIR_GAIN = 40.0
"""Log likelihood by which moving air must beat coloured instruments."""
AIR_MANEUVERS = 5
"""Enough to recognise turbulence by."""

LEAST_GUST_ANGLE = 0.001
"""Standard deviation of the air's angle below which turbulence is not worth a name, rad ..."""
_LEAST_GUST_PEAK = 0.0025
"""... and the peak below which a gust is not: one that passed once in a flight hardly has a deviation."""
_STANDS_OUT = 4.0
"""Power that one manoeuvre leaves, beside the median of all, from which on it is asked for a gust by itself:
noise with the same memory in all of them is no answer to what passed in one."""

_TRIED = 6
"""Sizes of a gust beforehand, from what turbulence would have to any ..."""
_AS_MUCH = 0.995
"""... and what a gentler course must take up of what the strongest does."""


@dataclass(frozen=True)
class Air:
    """Air that moves, as the data show it."""

    angle_std: float
    """Standard deviation of the gust angle w/V, rad."""
    gain: float
    gust: bool
    """One or few bumps in otherwise still air, not turbulence."""
    gust_number: int
    """Manoeuvre in which a gust shows most."""
    gust_angle: float
    """Largest departure of the air's angle there, rad."""
    gust_at_s: float
    """Vehicle time of its peak."""
    course: tuple[FloatArray, ...]
    """Per manoeuvre, shape (knots,): its likeliest angle, rad, every ``KNOTS_S``."""
    mean_square_beyond_air: FloatArray
    """Shape (channels,): mean square that stays when the likeliest course of the air is taken out."""
    residuals: tuple[FloatArray, ...]
    """The same per manoeuvre, stacked channels, in their units."""
    instruments: FloatArray
    """Shape (channels,): noise of the instruments beside it."""
    power: float
    """What its course takes up, mean over channels of the mean square beside the instruments' noise."""


def moving_air(problem: Problem, fitted: Fitted) -> Air | None:
    """The air's motion when it is there; None when noise of the instruments explains the residual as well."""
    if "alpha" not in problem.channels or "q" not in problem.channels:
        return None
    floor = 1.0 if problem.instruments is None else problem.instruments
    before = mean_squares(problem, fitted.residuals)
    power = np.mean(before / floor**2, axis=1)
    loudest = np.argsort(-power, kind="stable")[:AIR_MANEUVERS]
    found = _moving_in(problem, fitted, loudest)
    if found.gain < AIR_GAIN and _stands_out(power):
        found = _moving_in(problem, fitted, loudest[:1])
    # What coloured instruments gain alone is no air: then the air's angle is found to be nothing.
    if found.gain < AIR_GAIN or found.gust_angle <= 0.0:
        return None
    model = with_floor(problem, found.air)
    instruments = np.hypot(model.white, model.coloured)[[OUTPUTS.index(c) for c in problem.channels]]
    course = disturbance_courses(problem, fitted, instruments, "air", [found.gust_angle])[0]
    joined = np.concatenate(course.knots)
    typical = robust_std(joined - np.median(joined))
    # Gaussian air of this many samples reaches four times its spread, a lone gust far more.
    highest = float(np.max(np.abs(joined)))
    gust = highest > 6.0 * typical
    if found.gust_angle < LEAST_GUST_ANGLE and not (gust and highest > _LEAST_GUST_PEAK):
        return None
    if gust:
        course = _of_a_gust(problem, fitted, instruments, found.gust_angle)
    # Where no gust was, a course may wander far and change little, or hardly move and take up a slow drift.
    changed = np.mean((before - mean_squares(problem, course.residuals)) / floor**2, axis=1)
    peaks = np.array([np.max(np.abs(knots)) for knots in course.knots])
    number = int(np.argmax(peaks**2 * np.maximum(changed, 0.0)))
    at = int(np.argmax(np.abs(course.knots[number])))
    flight = problem.flights.flights[number]
    beyond = _mean_square(problem, course.residuals)
    taken = np.mean(before, axis=0) - beyond
    return Air(
        angle_std=found.gust_angle, gain=found.gain,
        gust=gust, gust_number=flight.number,
        gust_angle=float(course.knots[number][at]), gust_at_s=float(flight.started_s + KNOTS_S * (at + 1)),
        course=course.knots, mean_square_beyond_air=beyond, residuals=course.residuals,
        instruments=instruments, power=float(np.mean(taken / floor**2)),
    )  # fmt: skip


def one_maneuver_stands_out(problem: Problem, fitted: Fitted) -> bool:
    """Whether a model leaves far more of one manoeuvre than of most: a gust may have passed in it."""
    return _stands_out(np.mean(mean_squares(problem, fitted.innovations) / fitted.noise**2, axis=1))


def _stands_out(powers: FloatArray) -> bool:
    """Whether the loudest of the manoeuvres' powers, shape (manoeuvres,), does so beside the median."""
    return bool(np.max(powers) > _STANDS_OUT * np.median(powers))


def _moving_in(problem: Problem, fitted: Fitted, maneuvers: Iterable[int]) -> Turbulence:
    """Moving air against noise of the instruments, in what is left of some manoeuvres."""
    rows = [rows_of(problem, fitted, i) for i in maneuvers]
    derived = problem.flights.alpha_is_derived
    return find_turbulence(rows, system_of(problem, fitted), instrument_noise(problem), not derived)


def _of_a_gust(problem: Problem, fitted: Fitted, instruments: FloatArray, least: float) -> Course:
    """The gentlest course that explains as much as one that may be of any size.

    What the instruments hardly show would wander far in one that may be of any size.
    """
    sizes = [*np.geomspace(least, ANY_GUST, _TRIED)] if least < ANY_GUST else [ANY_GUST]
    courses = disturbance_courses(problem, fitted, instruments, "air", sizes)
    powers = [float(np.sum(_mean_square(problem, c.residuals) / instruments**2)) for c in courses]
    before = float(np.sum(np.mean(mean_squares(problem, fitted.residuals), axis=0) / instruments**2))
    enough = before - _AS_MUCH * (before - powers[-1])
    return next(c for c, rest in zip(courses, powers, strict=True) if rest <= enough)


def _mean_square(problem: Problem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,), over all manoeuvres; the air's own freedom (a knot each) counted against it."""
    knots = sum(f.duration_s / KNOTS_S for f in problem.flights.flights)
    samples = sum(len(residual) for residual in residuals)
    powers = np.mean(mean_squares(problem, residuals), axis=0)
    return np.asarray(powers / max(1.0 - knots / samples, 0.3))
