"""Priors of a fit: the aircraft file for the derivatives, near steady flight for each manoeuvre's start.

Either the simulator's derivatives are right and an effect is missing, or the derivatives are off by tens of
per cent. Right and wrong derivatives have equal prior probability. If the data leave a choice, the
explanation that keeps the file's derivatives is likelier. A record begins in nearly steady flight. Without
an angle of attack no other measurement determines its initial value.
"""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import DERIVATIVES, NUISANCES, REFERENCE
from advisor.model.outputs import SHARED
from advisor.oem.prior import HELD, precision_without_alpha
from advisor.process.arrays import FloatArray

ERROR_IF_RIGHT = 0.03
"""Prior: relative standard deviation of derivatives that are right: they are linearised, at a nearby
speed."""
ERROR_IF_WRONG = 0.3
"""Prior: relative standard deviation of derivatives that are wrong."""
_LEAST = 0.1
"""Prior: least size of a derivative for a relative error, 1/s or 1/s². A smaller derivative counts as
zero."""


def derivative_scale(prior: FloatArray) -> FloatArray:
    """Return the size of each derivative, shape (6,), that its relative error refers to."""
    z_alpha, _, z_delta, m_alpha, m_q, m_delta = np.abs(prior)
    z_alpha = max(z_alpha, _LEAST)
    return np.array(
        [
            z_alpha,
            1.0,
            max(z_delta, 0.3 * z_alpha),
            max(m_alpha, 0.1 * m_delta, _LEAST),
            max(m_q, 0.3 * np.sqrt(max(m_alpha, _LEAST))),
            max(m_delta, 0.3 * m_alpha, _LEAST),
        ]
    )


def prior_precision(prior: FloatArray, tolerance: float) -> FloatArray:
    """Return the inverse variances of the file's derivatives, given their relative error, shape (6,)."""
    return np.asarray(1.0 / (tolerance * derivative_scale(prior)) ** 2)


def small_without_alpha(derivatives: FloatArray) -> FloatArray:
    """Return the inverse variances about zero of derivatives that no angle of attack shows, shape (6,).

    The prior is that of the estimate (``advisor.oem.prior``).
    """
    shared = dict(zip(DERIVATIVES, derivatives, strict=True))
    precision = precision_without_alpha(np.array([shared.get(name, 0.0) for name in SHARED]))
    return precision[[SHARED.index(name) for name in DERIVATIVES]]


def holding(
    inverse: FloatArray, expected: FloatArray, fixed: Mapping[str, float]
) -> tuple[FloatArray, FloatArray]:
    """Return inverse variances and means (6,) of the derivatives, with those that the user holds known."""
    inverse, expected = np.array(inverse), np.array(expected)
    for name, value in fixed.items():
        k = DERIVATIVES.index(name)
        inverse[k], expected[k] = 1.0 / (HELD * max(abs(value), 1.0)) ** 2, value
    return inverse, expected


_START_RAD = 0.035
"""Prior: standard deviation of a record's initial angle of attack about the mean before the first step, rad.
Decaying motion or a gust changes the angle of attack by 2 deg."""
_LOAD_FACTOR = 0.3
"""Prior: standard deviation of the load factor in trim about that of level flight: a turn of 30 deg has
0.15."""


def own_mean(flight: PreparedManeuver) -> FloatArray:
    """Return the prior means of a manoeuvre's initial states and trim terms, shape (4,)."""
    mean = dict.fromkeys(NUISANCES, 0.0) | {"Z_trim": flight.level_lift}
    return np.array([mean[name] for name in NUISANCES])


def own_precision(flight: PreparedManeuver) -> FloatArray:
    """Return the inverse prior variances of a manoeuvre's initial states and trim terms, shape (4,).

    The pitch rate is measured, and no physics bounds the moment in trim: their priors are flat.
    """
    lift = _LOAD_FACTOR * GRAVITY_M_S2 / float(flight.trim[REFERENCE])
    stated = {"alpha_start": 1.0 / _START_RAD**2, "Z_trim": 1.0 / lift**2}
    return np.array([stated.get(name, 0.0) for name in NUISANCES])
