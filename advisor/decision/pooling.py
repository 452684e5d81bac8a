"""All manoeuvres together: single estimates combined by their information.

For the rules this stands in for the joint output error estimate: in the linear regime the two agree,
because the sum of quadratic costs has its minimum where the information-weighted mean lies. It needs no
data, only estimates and covariances, so that every decision of a campaign is recomputed in a blink.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.gravity import GRAVITY_M_S2
from advisor.model.short_period import SPEED_EXPONENTS
from advisor.oem.estimate import Estimate

INTERCEPTS = (PARAMETERS.index("Z_0"), PARAMETERS.index("M_0"))
"""Trim and speed differ from one manoeuvre to the next, so each has its own Z_0 and M_0."""
DERIVATIVES = tuple(k for k in range(len(PARAMETERS)) if k not in INTERCEPTS)

_D, _C = list(DERIVATIVES), list(INTERCEPTS)
_DD, _CC, _CD, _DC = np.ix_(_D, _D), np.ix_(_C, _C), np.ix_(_C, _D), np.ix_(_D, _C)
_SPEED_POWER = np.array([SPEED_EXPONENTS[name] for name in PARAMETERS], dtype=float)


class Shared(NamedTuple):
    """What is believed of the six derivatives, which manoeuvres share, in the order of ``DERIVATIVES``."""

    theta: FloatArray
    """Shape (6,)."""
    covariance: FloatArray
    """Shape (6, 6); infinite on the diagonal where nothing is known."""


@dataclass(frozen=True)
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

    @cached_property
    def shared(self) -> Shared:
        """The derivatives alone."""
        return Shared(self.theta[_D], self.covariance[_DD])

    @cached_property
    def information(self) -> FloatArray:
        """Shape (6, 6). Information about the derivatives, zero where nothing is known."""
        return information_of(self.shared.covariance)


def beliefs_at_one_speed(estimates: Sequence[Estimate]) -> list[Belief]:
    """The estimates brought to their mean air speed, where every one of them knows its own.

    Each parameter goes with its power of V (``SPEED_EXPONENTS``), gravity's part g/V of Z_0 apart.
    Estimates that already stand at one speed, or do not know theirs, are left as they are. The colour
    of the residuals is a matter of instruments and air, which the manoeuvres share: how much it widens
    the Cramér-Rao bounds is the median over them, steadier than each manoeuvre's own.
    """
    widening = _widening_by_colour(estimates)
    reference = common_airspeed(estimates)
    return [
        Belief(e.theta, e.covariance_cr * widening)
        if reference is None or e.airspeed_m_s is None
        else _at_speed(e, e.airspeed_m_s, reference, widening)
        for e in estimates
    ]


def common_airspeed(estimates: Sequence[Estimate]) -> float | None:
    """The mean of the speeds at which estimates are given; None where one of them does not know its own."""
    known = [e.airspeed_m_s for e in estimates if e.airspeed_m_s is not None and e.airspeed_m_s > 0.0]
    return float(np.mean(known)) if known and len(known) == len(estimates) else None


def _widening_by_colour(estimates: Sequence[Estimate]) -> FloatArray:
    """(8, 8) factor on the Cramér-Rao bounds: median ratio of corrected to plain errors, squared."""
    if not estimates:
        return np.ones((len(PARAMETERS), len(PARAMETERS)))
    plain = np.array([e.std_cr for e in estimates])
    corrected = np.array([e.std for e in estimates])
    usable = np.isfinite(plain) & np.isfinite(corrected) & (plain > 0.0)
    ratio = np.divide(corrected, plain, out=np.ones_like(plain), where=usable)
    median = np.median(ratio, axis=0)
    return np.outer(median, median)


def _at_speed(estimate: Estimate, speed: float, reference: float, widening: FloatArray) -> Belief:
    scale = (reference / speed) ** _SPEED_POWER
    gravity = np.zeros(len(PARAMETERS))
    gravity[PARAMETERS.index("Z_0")] = GRAVITY_M_S2
    theta = (estimate.theta - gravity / speed) * scale + gravity / reference
    return Belief(theta, estimate.covariance_cr * widening * np.outer(scale, scale))


def pool_shared(beliefs: Sequence[Belief]) -> Shared:
    """The information-weighted mean of the derivatives of at least one estimate."""
    information = np.sum([belief.information for belief in beliefs], axis=0)
    weighted = np.sum([b.information @ _finite(b.shared.theta) for b in beliefs], axis=0)
    covariance = covariance_of(information)
    known = np.isfinite(np.diag(covariance))
    return Shared(np.where(known, _finite(covariance) @ weighted, np.nan), covariance)


def pool(beliefs: Sequence[Belief]) -> Belief:
    """The information-weighted mean of several estimates, each with its own Z_0 and M_0.

    The six derivatives are shared; Z_0 and M_0 of the result are means over the manoeuvres, after
    each manoeuvre's own have been corrected for what the others say of its derivatives.

    Parameters
    ----------
    beliefs
        At least one.
    """
    shared = pool_shared(beliefs)
    n = len(beliefs)
    constants, gain, own = np.zeros(len(_C)), np.zeros((len(_C), len(_D))), np.zeros((len(_C), len(_C)))
    for belief in beliefs:
        cross = _finite(belief.covariance[_CD])
        each = cross @ belief.information
        constants += (belief.theta[_C] + each @ _finite(shared.theta - belief.shared.theta)) / n
        gain += each / n
        own += (belief.covariance[_CC] - each @ cross.T) / n**2
    theta, covariance = np.empty(len(PARAMETERS)), np.empty((len(PARAMETERS), len(PARAMETERS)))
    known = _finite(shared.covariance)
    theta[_D], theta[_C] = shared.theta, constants
    covariance[_DD], covariance[_CC] = shared.covariance, own + gain @ known @ gain.T
    covariance[_CD] = gain @ known
    covariance[_DC] = covariance[_CD].T
    return Belief(theta, covariance)


def disagreement(one: Shared, other: Shared) -> tuple[float, int]:
    """How far two independent estimates of the derivatives lie apart.

    Returns
    -------
    tuple of float and int
        Mahalanobis distance squared over the derivatives that both know, and their number: χ²
        distributed with that many degrees of freedom when nothing but noise separates the two.
    """
    return _distance(one.theta - other.theta, information_of(one.covariance + other.covariance))


def inconsistency(beliefs: Sequence[Belief]) -> tuple[float, int]:
    """How far several estimates of the derivatives lie from their pooled value.

    Returns
    -------
    tuple of float and int
        χ² and its degrees of freedom: those the estimates have together, less those the pooled value
        took.
    """
    centre = pool_shared(beliefs).theta
    total, dof = 0.0, -int(np.isfinite(centre).sum())
    for belief in beliefs:
        distance, size = _distance(belief.shared.theta - centre, belief.information)
        total, dof = total + distance, dof + size
    return total, dof


def inconsistency_without_each(beliefs: Sequence[Belief]) -> list[tuple[float, int]]:
    """As `inconsistency` of all the others, for each of at least two estimates left out in turn.

    χ² about the pooled value is Σ dᵢᵀIᵢdᵢ - vᵀCv with v = Σ Iᵢdᵢ and C = (Σ Iᵢ)⁻¹. The sums before and
    after each estimate are kept, so that all the χ² together cost little more than one.
    """
    centre = pool_shared(beliefs).theta
    information = np.array([belief.information for belief in beliefs])
    apart = np.array([_finite(belief.shared.theta - centre) for belief in beliefs])
    pull = np.einsum("nij,nj->ni", information, apart)
    own = np.einsum("ni,ni->n", pull, apart)
    known = np.count_nonzero(np.diagonal(information, axis1=1, axis2=2) > 0.0, axis=1)
    others, pulls, owns, sizes = (_sum_of_others(values) for values in (information, pull, own, known))
    found = []
    for k in range(len(beliefs)):
        covariance = covariance_of(others[k])
        pooled = np.isfinite(np.diag(covariance))
        explained = float(pulls[k] @ _finite(covariance) @ pulls[k])
        found.append((max(float(owns[k]) - explained, 0.0), int(sizes[k]) - int(pooled.sum())))
    return found


def _sum_of_others(values: FloatArray) -> FloatArray:
    """For each entry along the first axis the sum of all the others, without cancellation."""
    nothing = np.zeros_like(values[:1])
    before = np.concatenate([nothing, np.cumsum(values, axis=0)[:-1]])
    after = np.concatenate([np.cumsum(values[::-1], axis=0)[::-1][1:], nothing])
    return np.asarray(before + after)


def _finite(values: FloatArray) -> FloatArray:
    """Zero for what is unknown."""
    return np.where(np.isfinite(values), values, 0.0)


def _distance(difference: FloatArray, information: FloatArray) -> tuple[float, int]:
    known = np.isfinite(difference) & (np.diag(information) > 0.0)
    inside = np.where(known, difference, 0.0)
    return float(inside @ information @ inside), int(known.sum())


def information_of(covariance: FloatArray) -> FloatArray:
    """Inverse of a covariance; zero rows and columns for what is unknown (no finite, positive variance)."""
    variance = np.diag(covariance)
    known = np.isfinite(variance) & (variance > 0.0)
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
    outer = np.outer(scale, scale)
    try:
        half = np.linalg.inv(np.linalg.cholesky(matrix * outer))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrix * outer, hermitian=True)) * outer
    return np.asarray(half.T @ half) * outer
