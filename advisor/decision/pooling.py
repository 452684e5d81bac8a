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
from advisor.oem.estimate import Estimate

INTERCEPTS = (PARAMETERS.index("Z_0"), PARAMETERS.index("M_0"))
"""Trim and speed differ from one manoeuvre to the next, so each has its own Z_0 and M_0."""
DERIVATIVES = tuple(k for k in range(len(PARAMETERS)) if k not in INTERCEPTS)

# Powers of the air speed that the parameters go with at constant aerodynamic coefficients and air
# density. Z_q does not depend on speed; Z_0 and M_0 hold the trim and are left alone.
_SPEED_POWER = np.array([0.0, 1.0, 0.0, 1.0, 0.0, 2.0, 1.0, 2.0])


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

    Z_α, Z_δe and M_q go with V, M_α and M_δe with V². Estimates that already stand at one speed
    are left as they are.
    """
    speeds = [e.airspeed_m_s for e in estimates]
    known = [v for v in speeds if v is not None and v > 0.0]
    if len(known) < len(speeds):
        return [Belief(e.theta, e.covariance) for e in estimates]
    reference = float(np.mean(known))
    scales = [(reference / v) ** _SPEED_POWER for v in known]
    return [
        Belief(e.theta * s, e.covariance * np.outer(s, s)) for e, s in zip(estimates, scales, strict=True)
    ]


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
    theta_d = np.where(np.isfinite(np.diag(covariance_d)), _solve(information, weighted), np.nan)

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
    known = np.where(np.isfinite(covariance_d), covariance_d, 0.0)
    theta[c] = np.mean(intercepts, axis=0)
    covariance[np.ix_(c, c)] = own / n**2 + gain @ known @ gain.T
    covariance[np.ix_(c, d)] = gain @ known
    covariance[np.ix_(d, c)] = (gain @ known).T
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
    difference = belief.theta[d] - other.theta[d]
    total = belief.covariance[np.ix_(d, d)] + other.covariance[np.ix_(d, d)]
    both = np.isfinite(difference) & np.isfinite(np.diag(total))
    if not both.any():
        return 0.0, 0
    difference, total = difference[both], total[np.ix_(both, both)]
    return float(difference @ _solve(total, difference)), int(both.sum())


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


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    known = np.diag(matrix) > 0.0
    solution = np.zeros_like(right)
    if known.any():
        solution[known] = _inverse(matrix[np.ix_(known, known)]) @ right[known]
    return solution
