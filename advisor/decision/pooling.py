"""All manoeuvres together: single estimates combined by their information.

For the rules this stands in for the joint output error estimate: in the linear regime the two agree,
because the sum of quadratic costs has its minimum where the information-weighted mean lies. It needs no
data, only estimates and covariances, so that every decision of a campaign is recomputed in a blink.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.model.short_period import SPEED_EXPONENTS
from advisor.oem.estimate import Estimate

INTERCEPTS = (PARAMETERS.index("Z_0"), PARAMETERS.index("M_0"))
"""Trim and speed differ from one manoeuvre to the next, so each has its own Z_0 and M_0."""
DERIVATIVES = tuple(k for k in range(len(PARAMETERS)) if k not in INTERCEPTS)

_SPEED_POWER = np.array([SPEED_EXPONENTS[name] for name in PARAMETERS], dtype=float)
_GRAVITY = 9.80665


@dataclass(frozen=True, slots=True)
class Belief:
    """What is believed of θ: mean and covariance."""

    theta: FloatArray
    """Shape (8,), order of ``PARAMETERS``."""
    covariance: FloatArray
    """Shape (8, 8); infinite on the diagonal where nothing is known."""

    @property
    def std(self) -> FloatArray:
        """Shape (8,)."""
        return np.sqrt(np.diag(self.covariance))


def beliefs_at_one_speed(estimates: Sequence[Estimate]) -> list[Belief]:
    """The estimates brought to their mean air speed, where every one of them knows its own.

    Each parameter goes with its power of V (``SPEED_EXPONENTS``), gravity's part g/V of Z_0 apart.
    Estimates that already stand at one speed, or do not know theirs, are left as they are.
    """
    known = [e.airspeed_m_s for e in estimates if e.airspeed_m_s is not None and e.airspeed_m_s > 0.0]
    if not known or len(known) < len(estimates):
        return [Belief(e.theta, e.covariance) for e in estimates]
    reference = float(np.mean(known))
    return [_at_speed(e, v, reference) for e, v in zip(estimates, known, strict=True)]


def _at_speed(estimate: Estimate, speed: float, reference: float) -> Belief:
    scale = (reference / speed) ** _SPEED_POWER
    gravity = np.zeros(len(PARAMETERS))
    gravity[PARAMETERS.index("Z_0")] = _GRAVITY
    theta = (estimate.theta - gravity / speed) * scale + gravity / reference
    return Belief(theta, estimate.covariance * np.outer(scale, scale))


def pool(beliefs: Sequence[Belief]) -> Belief:
    """The information-weighted mean of several estimates, each with its own Z_0 and M_0.

    The six derivatives are shared; Z_0 and M_0 of the result are means over the manoeuvres, after
    each manoeuvre's own have been corrected for what the others say of its derivatives.

    Parameters
    ----------
    beliefs
        At least one.
    """
    d, c = list(DERIVATIVES), list(INTERCEPTS)
    information = np.zeros((len(d), len(d)))
    weighted = np.zeros(len(d))
    for belief in beliefs:
        weight = information_of(belief.covariance[np.ix_(d, d)])
        information += weight
        weighted += weight @ np.where(np.isfinite(belief.theta[d]), belief.theta[d], 0.0)
    covariance_d = covariance_of(information)
    known = np.isfinite(np.diag(covariance_d))
    shared = np.where(np.isfinite(covariance_d), covariance_d, 0.0)
    theta_d = np.where(known, shared @ weighted, np.nan)

    theta = np.empty(len(PARAMETERS))
    covariance = np.zeros((len(PARAMETERS), len(PARAMETERS)))
    theta[d], covariance[np.ix_(d, d)] = theta_d, covariance_d
    intercepts, gains, own = [], [], np.zeros((len(c), len(c)))
    for belief in beliefs:
        cross = belief.covariance[np.ix_(c, d)]
        gain = np.nan_to_num(cross) @ information_of(belief.covariance[np.ix_(d, d)])
        intercepts.append(belief.theta[c] + gain @ np.nan_to_num(theta_d - belief.theta[d]))
        gains.append(gain)
        own += belief.covariance[np.ix_(c, c)] - gain @ np.nan_to_num(cross).T
    n = len(beliefs)
    gain = np.mean(gains, axis=0)
    theta[c] = np.mean(intercepts, axis=0)
    covariance[np.ix_(c, c)] = own / n**2 + gain @ shared @ gain.T
    covariance[np.ix_(c, d)] = gain @ shared
    covariance[np.ix_(d, c)] = (gain @ shared).T
    return Belief(theta, covariance)


def disagreement(belief: Belief, other: Belief) -> tuple[float, int]:
    """How far two independent estimates of the derivatives lie apart.

    Returns
    -------
    tuple of float and int
        Mahalanobis distance squared over the derivatives that both know, and their number: χ²
        distributed with that many degrees of freedom when nothing but noise separates the two.
    """
    d = list(DERIVATIVES)
    total = belief.covariance[np.ix_(d, d)] + other.covariance[np.ix_(d, d)]
    return _distance(belief.theta[d] - other.theta[d], information_of(total))


def inconsistency(beliefs: Sequence[Belief]) -> tuple[float, int]:
    """How far several estimates of the derivatives lie from their pooled value.

    Returns
    -------
    tuple of float and int
        χ² and its degrees of freedom: those the estimates have together, less those the pooled value
        took.
    """
    d = list(DERIVATIVES)
    centre = pool(beliefs).theta[d]
    total, dof = 0.0, -int(np.isfinite(centre).sum())
    for belief in beliefs:
        distance, size = _distance(belief.theta[d] - centre, information_of(belief.covariance[np.ix_(d, d)]))
        total, dof = total + distance, dof + size
    return total, dof


def _distance(difference: FloatArray, information: FloatArray) -> tuple[float, int]:
    known = np.isfinite(difference) & (np.diag(information) > 0.0)
    inside = np.where(known, difference, 0.0)
    return float(inside @ information @ inside), int(known.sum())


def information_of(covariance: FloatArray) -> FloatArray:
    """Inverse of a covariance; zero rows and columns for what is unknown (not finite)."""
    known = np.isfinite(np.diag(covariance))
    information = np.zeros_like(covariance)
    block = np.ix_(known, known)
    if known.any():
        information[block] = _inverse(covariance[block])
    return information


def covariance_of(information: FloatArray) -> FloatArray:
    """Inverse of an information matrix; infinite variance for what it says nothing about."""
    known = np.diag(information) > 0.0
    covariance = np.zeros_like(information)
    covariance[~known, ~known] = np.inf
    block = np.ix_(known, known)
    if known.any():
        covariance[block] = _inverse(information[block])
    return covariance


def _inverse(matrix: FloatArray) -> FloatArray:
    """Inverse of a symmetric positive semi-definite matrix, scaled so that units do not matter."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    return np.asarray(np.linalg.pinv(matrix * np.outer(scale, scale), hermitian=True)) * np.outer(
        scale, scale
    )
