"""The air speed at which the aircraft file's derivatives hold, where the file states none.

The mean speed of the manoeuvres is the default. A manoeuvre costs speed, and pilots begin one slower than the
last. Derivatives of the trim speed can then be off by some per cent, all by their power of the speed.
"""

import numpy as np

from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.prior import distance_of
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import covariance, distance_from_file, effective_samples
from advisor.gap.simulator.layout import DERIVATIVES, SPEED

_POWERS = np.array([float(SPEED_EXPONENTS[name]) for name in DERIVATIVES])
"""Power of the air speed with which each derivative grows."""
_FARTHEST = 0.06
"""Prior: largest relative distance of the speed from the mean. Derivatives that hold at no speed within it
are wrong ones."""
_TRIED = 25
"""Numerical: number of speeds that are tried."""


def prior_speed(problem: EffectProblem, baseline: EffectFit) -> float | None:
    """Return the speed in m/s, within those flown, at which the file's derivatives are right.

    None where they may be right at the mean speed of the manoeuvres, or are wrong at every speed.
    """
    flights, prior = problem.flights, problem.prior_derivatives
    if prior is None or not flights.speed_measured or not distance_from_file(problem, baseline).is_off:
        return None
    flown = np.concatenate([flight.slow[SPEED] for flight in flights.flights]) / flights.reference_m_s
    lowest, highest = max(np.min(flown), 1.0 - _FARTHEST), min(np.max(flown), 1.0 + _FARTHEST)
    n = len(prior)
    known = covariance(problem, baseline, effective_samples(problem, baseline.innovations))[:n, :n]
    shares = np.linspace(lowest, highest, _TRIED)
    off = [distance_of(baseline.point.derivatives, known, prior * share**-_POWERS) for share in shares]
    right, wrong = [d.log_right for d in off], [d.log_wrong for d in off]
    # Any speed that was flown is alike likely, for right and for wrong derivatives.
    if np.logaddexp.reduce(wrong) > np.logaddexp.reduce(right):
        return None
    return float(shares[int(np.argmax(right))] * flights.reference_m_s)
