"""Air speed at which the aircraft file's derivatives hold, if the file states no speed.

The mean speed of the manoeuvres is the default. Each manoeuvre costs speed, and pilots may begin the next
manoeuvre slower. Derivatives stated for the trim speed can then be off by some per cent, by their power of
the speed.
"""

import numpy as np

from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG, prior_precision
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import colour_of, covariance_of
from advisor.gap.inference.explanation import Evidence
from advisor.gap.inference.marginal import Prior, marginal
from advisor.gap.simulator.layout import DERIVATIVES, SPEED
from advisor.process.arrays import FloatArray

_POWERS = np.array([float(SPEED_EXPONENTS[name]) for name in DERIVATIVES])
"""Exponent of the air speed for each derivative."""
_FARTHEST = 0.06
"""Prior: largest relative distance of the derivatives' speed from the mean speed. Derivatives that hold at no
speed within this distance are wrong."""
_TRIED = 25
"""Numerical: number of candidate speeds."""


def prior_speed(problem: EffectProblem, baseline: EffectFit) -> float | None:
    """Return the speed in m/s, within those flown, at which the file's derivatives are right.

    None if the derivatives may be right at the mean speed, or are wrong at every speed.
    """
    flights, prior = problem.flights, problem.prior_derivatives
    if prior is None or not flights.speed_measured:
        return None
    n = len(prior)
    derivatives = baseline.point.derivatives
    cov = covariance_of(problem, baseline, colour_of(problem, baseline))[:n, :n]
    here = evidence_of_file(derivatives, cov, prior)
    if here.right >= here.wrong:
        return None
    flown = np.concatenate([flight.slow[SPEED] for flight in flights.flights]) / flights.reference_m_s
    lowest, highest = max(np.min(flown), 1.0 - _FARTHEST), min(np.max(flown), 1.0 + _FARTHEST)
    shares = np.linspace(lowest, highest, _TRIED)
    each = [evidence_of_file(derivatives, cov, prior * share**-_POWERS) for share in shares]
    # Any speed that was flown is alike likely, for right and for wrong derivatives.
    if np.logaddexp.reduce([e.wrong for e in each]) > np.logaddexp.reduce([e.right for e in each]):
        return None
    return float(shares[int(np.argmax([e.right for e in each]))] * flights.reference_m_s)


def evidence_of_file(derivatives: FloatArray, cov: FloatArray, prior: FloatArray) -> Evidence:
    """Return the evidence for right and for wrong derivatives (6,) of an aircraft file.

    ``derivatives`` (6,) and ``cov`` (6, 6) are the fitted derivatives and their covariance.
    """
    right, wrong = (
        Prior(prior_precision(prior, tolerance), prior - derivatives)
        for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG)
    )
    return marginal(0.0, np.asarray(np.linalg.inv(cov)), np.zeros(len(prior)), right, wrong)
