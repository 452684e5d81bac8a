"""At which speed do the aircraft file's numbers hold, where it does not say?

They count for the mean of the manoeuvres then. But a manoeuvre costs speed, and pilots begin one slower than
the last: numbers of the trim are some per cent off, all by what the speed makes of them.
"""

import numpy as np

from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.prior import distance_of, log_prior
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import covariance, effective_samples, file_is_off
from advisor.gap.simulator.layout import DERIVATIVES, SPEED
from advisor.model.short_period import SPEED_EXPONENTS

_POWERS = np.array([float(SPEED_EXPONENTS[name]) for name in DERIVATIVES])
"""Of the speed, by which each derivative grows with it."""
_FARTHEST = 0.06
"""Relative: numbers that hold at no speed near those of the flight are wrong ones."""
_TRIED = 25


def prior_speed(problem: Problem, baseline: Fitted) -> float | None:
    """The speed in m/s, of those flown, at which the file's numbers are right.

    None where they may be right at the mean of the manoeuvres, or are wrong at any speed.
    """
    flights, prior = problem.flights, problem.prior_derivatives
    if prior is None or not flights.speed_measured or not file_is_off(problem, baseline, clear_gap=True):
        return None
    flown = np.concatenate([flight.slow[SPEED] for flight in flights.flights]) / flights.reference_m_s
    lowest, highest = max(np.min(flown), 1.0 - _FARTHEST), min(np.max(flown), 1.0 + _FARTHEST)
    n = len(prior)
    known = covariance(problem, baseline, effective_samples(problem, baseline.innovations))[:n, :n]
    shares = np.linspace(lowest, highest, _TRIED)
    at_speeds = [prior * share**-_POWERS for share in shares]
    best = int(np.argmax([log_prior(baseline.point.derivatives, known, there) for there in at_speeds]))
    if distance_of(baseline.point.derivatives, known, at_speeds[best], clear_gap=True).is_off:
        return None
    return float(shares[best] * flights.reference_m_s)
