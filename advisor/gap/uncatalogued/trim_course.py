"""The course of trims and offsets over the flight: what creeps between manoeuvres.

Every manoeuvre has its own trim and offsets. They absorb a slow change such as creeping flaps, a drifting
trim or a sagging attitude. Over all manoeuvres such a change is a slope in time.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.step import solve_blocks
from advisor.gap.result import Course
from advisor.gap.simulator.layout import INDEX, NUISANCES

_LEAST_MANEUVERS = 4
"""Least number of manoeuvres for a slope with an error: two more than its two parameters."""


def course_of(quantity: str, at_s: Sequence[float], values: FloatArray) -> Course | None:
    """Return the slope of values, shape (manoeuvres,), in time; None for too few or unknown values.

    A change of the line that one manoeuvre alone makes counts as scatter.
    """
    known = np.isfinite(values)
    if np.count_nonzero(known) < _LEAST_MANEUVERS:
        return None
    t, y = np.asarray(at_s)[known], values[known]
    if np.ptp(t) <= 0.0:
        return None
    line = np.column_stack([np.ones(len(t)), t - np.mean(t)])
    fitted, *_ = np.linalg.lstsq(line, y, rcond=None)
    scatter = float(np.sum((y - line @ fitted) ** 2)) / (len(t) - 2)
    std = np.sqrt(scatter / np.sum(line[:, 1] ** 2))
    return Course(quantity, float(fitted[1]), float(std), len(t))


def trim_courses(problem: EffectProblem, fitted: EffectFit) -> tuple[Course, ...]:
    """Return the courses of trims and offsets of a fitted model."""
    flights = problem.flights.flights
    at_s = [flight.started_s for flight in flights]
    p, own = problem.driving(fitted.point), fitted.point.own
    trims = np.array([[flight.alpha_trim, flight.u_trim] for flight in flights])

    def at_zero(term: str, by_alpha: str, by_elevator: str) -> FloatArray:
        slopes = p[:, [INDEX[by_alpha], INDEX[by_elevator]]]
        return np.asarray(own[:, NUISANCES.index(term)] - np.sum(slopes * trims, axis=1))

    moments = at_zero("M_trim", "M_alpha", "M_delta_e") / -p[:, INDEX["M_delta_e"]]
    lifts = at_zero("Z_trim", "Z_alpha", "Z_delta_e") / -p[:, INDEX["Z_alpha"]]
    found = [course_of("elevator_trim", at_s, moments), course_of("zero_lift_alpha", at_s, lifts)]
    if "a_z" in problem.channels:
        free = solve_blocks(problem, fitted.linear, 1.0 / fitted.noise, fitted.point).free
        offsets = np.array([nuisances[len(NUISANCES)] for nuisances in free])
        found.append(course_of("a_z_offset", at_s, offsets))
    return tuple(course for course in found if course is not None)
