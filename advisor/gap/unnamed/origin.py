"""Stick or motion: what an unknown pitching moment follows.

A servo that sticks and a pitching moment without a name push the aircraft alike; only the little lift of the
elevator tells them apart. But what happens between stick and surface follows the stick and what it did
before, and an aerodynamic moment follows the motion. The course of the unknown moment is regressed on
either, and each regression judged on manoeuvres that it has not seen. Where neither predicts it, an actuator
for which play or the like was named is likelier to do something else besides than one for which nothing was.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.traits import KINKED
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import folds_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import KNOTS_S, Probe, disturbance_courses
from advisor.gap.records.flights import Flight
from advisor.gap.unnamed.course import has_tone

ALIKE = frozenset({"input", "moment_equation"})
_TIED = 10.0
"""Difference in log likelihood below which the two blocks explain a residual equally well."""
_TELLING = 0.1
"""Share of the course that the better regression must predict."""
_RIDGE = 0.1
_GRID_S = 0.02
_LAGS_S = (0.0, 0.1, 0.2, 0.4)
"""Of the regression of a course on what the stick or the motion did, its grid, and how long before."""
_WIDTHS = (0.15, 0.3, 0.6)
"""Of play and stiction, as shares of the stick's largest deflection."""


def stick_or_motion(
    problem: Problem, fitted: Fitted, noise: FloatArray, probes: Sequence[Probe]
) -> str | None:
    """``input`` or ``moment_equation`` where the two are likeliest and tied; None where they are not.

    Parameters
    ----------
    noise
        Shape (channels,): of the instruments.
    probes
        Likeliest first, from ``probe_blocks``.
    """
    tied = probes[0].gain - probes[1].gain <= _TIED
    if not tied or {probes[0].block, probes[1].block} != ALIKE or "alpha" not in problem.channels:
        return None
    size = next(p.size for p in probes if p.block == "moment_equation")
    course = disturbance_courses(problem, fitted, noise, "moment_equation", [size])[0]
    named = {variant.effect for variant in fitted.point.effects}
    otherwise = "input" if named & KINKED else "moment_equation"
    return followed(problem.flights.flights, course.knots) or otherwise


def followed(flights: Sequence[Flight], courses: Sequence[FloatArray]) -> str | None:
    """The block whose quantities predict an unknown moment's courses, one value every ``KNOTS_S``."""
    times = [KNOTS_S * np.arange(1.0, len(course) + 1.0) for course in courses]
    predicted = {
        block: _predicted([of(f, t) for f, t in zip(flights, times, strict=True)], courses)
        for block, of in (("input", _of_the_stick), ("moment_equation", _of_the_motion))
    }
    if has_tone(courses):
        # With what swings of itself the motion swings, too, and predicts it; the stick only what it makes.
        return "input" if predicted["input"] > _TELLING else None
    likelier = max(predicted, key=lambda block: predicted[block])
    return likelier if predicted[likelier] > _TELLING else None


def _predicted(features: Sequence[FloatArray], courses: Sequence[FloatArray]) -> float:
    """Share of the courses' variance that features predict in manoeuvres kept out."""
    X = [x - x.mean(axis=0) for x in features]
    y = [course - course.mean() for course in courses]
    missed = 0.0
    for fold in folds_of(len(y)):
        rest = [i for i in range(len(y)) if i not in fold]
        if not rest:
            return 0.0
        A = np.vstack([X[i] for i in rest])
        scale = np.std(A, axis=0) + 1e-12
        A = A / scale
        normal = A.T @ A + _RIDGE * len(A) * np.eye(A.shape[1])
        weights = np.linalg.solve(normal, A.T @ np.concatenate([y[i] for i in rest])) / scale
        missed += sum(float(np.sum((y[i] - X[i] @ weights) ** 2)) for i in fold)
    return 1.0 - missed / max(sum(float(v @ v) for v in y), 1e-300)


def _of_the_stick(flight: Flight, t: FloatArray) -> FloatArray:
    """The command now and before, bent, and what play or stiction takes off it; shape (n, 12)."""
    grid = np.arange(0.0, flight.duration_s, _GRID_S)
    stick = np.interp(grid, flight.t_u, flight.u) - flight.u_trim
    largest = float(np.max(np.abs(stick)))
    columns = [np.interp(t - lag, grid, stick) for lag in _LAGS_S]
    bent = [stick * np.abs(stick), stick**3]
    bent += [stick - follow(stick, w * largest) for w in _WIDTHS for follow in (_played, _stuck)]
    return np.column_stack([*columns, *(np.interp(t, grid, y) for y in bent)])


def _played(stick: FloatArray, width: float) -> FloatArray:
    """What follows a stick through play of a half-width."""
    out = np.empty_like(stick)
    at = stick[0]
    for i, x in enumerate(stick):
        at = min(max(at, x - width), x + width)
        out[i] = at
    return out


def _stuck(stick: FloatArray, breakaway: float) -> FloatArray:
    """What rests until a stick is far enough off, and then jumps there."""
    out = np.empty_like(stick)
    at = stick[0]
    for i, x in enumerate(stick):
        at = x if abs(x - at) > breakaway else at
        out[i] = at
    return out


def _of_the_motion(flight: Flight, t: FloatArray) -> FloatArray:
    """Angle of attack and pitch rate, bent and multiplied; shape (n, 9)."""
    alpha, q = (np.interp(t, flight.outputs[c].t, flight.outputs[c].y) for c in ("alpha", "q"))
    a = alpha - flight.alpha_trim
    return np.column_stack([a, q, a**2, a * np.abs(a), a**3, q * np.abs(q), q**2, a * q, np.abs(q)])
