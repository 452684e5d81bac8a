"""Moving air: turbulence and gusts, distinguished from coloured instrument noise by their pattern.

A gust enters vane, lift and moment at once; coloured instrument noise enters one channel. The Kalman
likelihood of ``advisor.oem.turbulence`` decides. The probe of the air block gives the course of the gust.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.record import robust_std
from advisor.gap.decision import CERTAIN
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import mean_squares
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.quiet import (
    DisturbanceCourse,
    disturbance_courses,
    instrument_noise,
    largest_gust,
    quiet_rows,
    rows_of,
    with_floor,
)
from advisor.model.outputs import OUTPUTS
from advisor.oem.turbulence import KNOTS_S, Turbulence, find_turbulence
from advisor.process.arrays import FloatArray

AIR_MANEUVERS = 5
"""Numerical: number of the noisiest manoeuvres in which moving air is sought."""

LEAST_GUST_ANGLE = 0.001
"""Least standard deviation of the gust angle, rad, for which the air counts as moving: 0.025 m/s at 25 m/s.
Calm logs of ArduPlane's simulator show 0.0002 to 0.0012, with gains of 330 to 400 nats. If a model error is
mistaken for moving air, an improved simulator looks too good."""
NATURAL_GUST_ANGLE = 0.006
"""Largest standard deviation of the gust angle, rad, that is natural in every flight and no cause. At 25 m/s
the limit is 0.15 m/s, the lightest turbulence named in flights of three generators."""
_STANDS_OUT = 4.0
"""Residual power of one manoeuvre over the median of all, above which a gust is sought in that manoeuvre.
Noise of equal colour in all manoeuvres does not explain a manoeuvre that stands out."""
_TRIED = 6
"""Numerical: number of candidate prior sizes of a gust."""
_AS_MUCH = 0.995
"""Numerical: least share of the residual that a gentler gust must explain, relative to the strongest gust."""


@dataclass(frozen=True)
class MovingAir:
    """Moving air, as estimated from the data."""

    angle_std: float
    """Standard deviation of the gust angle w/V, rad."""
    gain: float
    gust: bool
    """Whether the air has one or a few gusts and is otherwise still."""
    gust_number: int
    """Number of the manoeuvre in which a gust is strongest."""
    gust_angle: float
    """Largest deviation of the gust angle in the gust's manoeuvre, rad."""
    gust_at_s: float
    """Vehicle time of the gust's peak, s."""
    mean_square_beyond_air: FloatArray
    """Shape (channels,): mean square of the residual without the likeliest course of the air."""
    residuals: tuple[FloatArray, ...]
    """Per manoeuvre: residuals of the stacked channels without the likeliest course of the air, in the
    channels' units."""
    instruments: FloatArray
    """Shape (channels,): instrument noise in addition to moving air."""
    steady: float
    """Log density, nats, at most 0, of air that is stronger in the manoeuvres than in the quiet stretches."""

    @property
    def is_natural(self) -> bool:
        """Whether the air moves no more than in any natural flight, so that it is no cause."""
        return not self.gust and self.angle_std < NATURAL_GUST_ANGLE


@dataclass(frozen=True)
class SoughtAir:
    """Result of a search for moving air, with or without air found."""

    gain: float = 0.0
    """Log likelihood gain of moving air over coloured instruments, nats."""
    found: MovingAir | None = None


def moving_air(problem: EffectProblem, fitted: EffectFit) -> SoughtAir:
    """Seek moving air; instrument noise that explains the residual equally well is preferred."""
    if not problem.flights.shows_air:
        return SoughtAir()
    floor = 1.0 if problem.instruments is None else problem.instruments
    before = mean_squares(problem, fitted.residuals)
    power = np.mean(before / floor**2, axis=1)
    loudest = np.argsort(-power, kind="stable")[:AIR_MANEUVERS]
    air_fit = _moving_in(problem, fitted, loudest)
    if air_fit.gain < CERTAIN and np.max(power) > _STANDS_OUT * np.median(power):
        air_fit = _moving_in(problem, fitted, loudest[:1])
    # A gain that coloured instruments bring alone gives a gust angle of zero, and is no moving air.
    nothing = SoughtAir(air_fit.gain)
    if air_fit.gain < CERTAIN or air_fit.gust_angle <= 0.0:
        return nothing
    model = with_floor(problem, air_fit.noise)
    instruments = np.hypot(model.white, model.coloured)[[OUTPUTS.index(c) for c in problem.channels]]
    course = disturbance_courses(problem, fitted, instruments, "air", [air_fit.gust_angle])[0]
    joined = np.concatenate(course.knots)
    typical = robust_std(joined - np.median(joined))
    # Gaussian air of this many samples reaches four times its standard deviation, a lone gust far more.
    highest = float(np.max(np.abs(joined)))
    gust = highest > 6.0 * typical
    if air_fit.gust_angle < LEAST_GUST_ANGLE and not (gust and highest > NATURAL_GUST_ANGLE):
        return nothing
    if gust:
        course = _of_a_gust(problem, fitted, instruments, air_fit.gust_angle)
    # Without a gust, a course may wander far and change little, or hardly move and explain a slow drift.
    changed = np.mean((before - mean_squares(problem, course.residuals)) / floor**2, axis=1)
    peaks = np.array([np.max(np.abs(knots)) for knots in course.knots])
    number = int(np.argmax(peaks**2 * np.maximum(changed, 0.0)))
    at = int(np.argmax(np.abs(course.knots[number])))
    flight = problem.flights.flights[number]
    air = MovingAir(
        angle_std=air_fit.gust_angle, gain=air_fit.gain,
        gust=gust, gust_number=flight.number,
        gust_angle=float(course.knots[number][at]), gust_at_s=float(flight.started_s + KNOTS_S * (at + 1)),
        mean_square_beyond_air=_mean_square(problem, course.residuals), residuals=course.residuals,
        instruments=instruments, steady=0.0 if gust else _steady(problem, fitted, air_fit),
    )  # fmt: skip
    return replace(nothing, found=air)


def _steady(problem: EffectProblem, fitted: EffectFit, air_fit: Turbulence) -> float:
    """Return the log density of turbulence of equal strength with and without an input, relative to its peak.

    Turbulence does not depend on the elevator. A disturbance that the elevator drives ends when the elevator
    rests. A record shows one independent square per correlation time of the air. The log of a standard
    deviation from n squares is known to (2 n)^-1/2 (Bendat and Piersol, *Random Data*, chapter 8).
    """
    rows = quiet_rows(problem, fitted)
    if not rows:
        return 0.0
    quiet = find_turbulence(rows, instrument_noise(problem))
    lengths = (
        sum(float(row.t[-1] - row.t[0]) for row in rows),
        sum(flight.duration_s for flight in problem.flights.flights[:AIR_MANEUVERS]),
    )
    variance = sum(air_fit.noise.gust_memory_s / (2.0 * max(length, 1e-9)) for length in lengths)
    excess = np.log(air_fit.gust_angle / max(quiet.gust_angle, LEAST_GUST_ANGLE))
    return float(-0.5 * max(excess, 0.0) ** 2 / variance)


def _moving_in(problem: EffectProblem, fitted: EffectFit, maneuvers: Iterable[int]) -> Turbulence:
    """Return the likelihood of moving air in the residuals of the given manoeuvres."""
    rows = [rows_of(problem, fitted, i) for i in maneuvers]
    return find_turbulence(rows, instrument_noise(problem))


def _of_a_gust(
    problem: EffectProblem, fitted: EffectFit, instruments: FloatArray, least: float
) -> DisturbanceCourse:
    """Return the gentlest gust that explains almost as much of the residual as the largest gust shown."""
    most = largest_gust(problem.flights, float(fitted.point.derivatives[0]))
    sizes = [*np.geomspace(least, most, _TRIED)] if least < most else [most]
    courses = disturbance_courses(problem, fitted, instruments, "air", sizes)
    # A prior of one size allows courses of several times that size.
    shown = [c for c in courses if max(float(np.max(np.abs(knots))) for knots in c.knots) <= most]
    courses = shown or courses[:1]
    powers = [float(np.sum(_mean_square(problem, c.residuals) / instruments**2)) for c in courses]
    before = float(np.sum(np.mean(mean_squares(problem, fitted.residuals), axis=0) / instruments**2))
    enough = before - _AS_MUCH * (before - powers[-1])
    return next(c for c, rest in zip(courses, powers, strict=True) if rest <= enough)


def _mean_square(problem: EffectProblem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Return the mean square over all manoeuvres, shape (channels,), corrected for a knot per ``KNOTS_S``."""
    knots = sum(f.duration_s / KNOTS_S for f in problem.flights.flights)
    samples = sum(len(residual) for residual in residuals)
    powers = np.mean(mean_squares(problem, residuals), axis=0)
    return np.asarray(powers / max(1.0 - knots / samples, 0.3))
