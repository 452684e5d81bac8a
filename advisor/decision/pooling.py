"""Combination of single manoeuvres' estimates by their information.

For the rules, the pooled estimate replaces the joint output-error estimate. In the linear regime both agree,
because a sum of quadratic costs has its minimum at the information-weighted mean. Pooling needs only
estimates and covariances, so every decision is quickly recomputed.

``covariance_of`` and ``information_of`` accept one matrix or a stack of matrices.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from math import nan
from typing import NamedTuple

import numpy as np

from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.oem.estimate import Estimate
from advisor.oem.prior import HELD
from advisor.process.arrays import FloatArray


def information_of(covariance: FloatArray) -> FloatArray:
    """Return the inverse of covariances (..., n, n), with zero rows and columns for unknown parameters.

    A parameter is unknown if its variance is not finite and positive.
    """
    variance = np.diagonal(covariance, axis1=-2, axis2=-1)
    return _inverse(covariance, np.isfinite(variance) & (variance > 0.0), 0.0)


def covariance_of(information: FloatArray) -> FloatArray:
    """Return the inverse of information matrices (..., n, n), with infinite variance for parameters without
    information."""
    return _inverse(information, np.diagonal(information, axis1=-2, axis2=-1) > 0.0, np.inf)


def _inverse(matrix: FloatArray, is_known: np.ndarray, unknown: float) -> FloatArray:
    """Return inverses of symmetric matrices (..., n, n): unknown rows zero, ``unknown`` on the diagonal."""
    inside = is_known[..., :, None] & is_known[..., None, :]
    identity = np.eye(matrix.shape[-1])
    scale = 1.0 / np.sqrt(np.where(is_known, np.diagonal(matrix, axis1=-2, axis2=-1), 1.0))
    outer = scale[..., :, None] * scale[..., None, :]
    scaled = np.where(inside, matrix * outer, identity)
    try:
        half = np.linalg.inv(np.linalg.cholesky(scaled))
        inverse = np.swapaxes(half, -2, -1) @ half
    except np.linalg.LinAlgError:
        if matrix.ndim > 2:
            return np.array([_inverse(m, k, unknown) for m, k in zip(matrix, is_known, strict=True)])
        inverse = np.linalg.pinv(scaled, hermitian=True)
    without = np.where((identity > 0.0) & ~is_known[..., None], unknown, 0.0)
    return np.where(inside, inverse * outer, without)


INTERCEPTS = (PARAMETERS.index("Z_0"), PARAMETERS.index("M_0"))
"""Indices of the intercepts Z_0 and M_0 in θ. Trim and speed differ between manoeuvres, so each manoeuvre has
separate values of Z_0 and M_0."""
DERIVATIVES = tuple(k for k in range(len(PARAMETERS)) if k not in INTERCEPTS)


@cache
def _places(names: tuple[str, ...]) -> tuple[list[int], list[int]]:
    """Return the indices of the derivatives and of the intercepts among the parameters of an axis."""
    intercepts = [k for k, name in enumerate(names) if name.endswith("_0")]
    return [k for k in range(len(names)) if k not in intercepts], intercepts


def derivatives_of(names: tuple[str, ...]) -> list[str]:
    """Return the names of the derivatives among the parameters of an axis."""
    return [names[k] for k in _places(names)[0]]


class Shared(NamedTuple):
    """Mean and covariance of an axis' d derivatives, which all manoeuvres share."""

    theta: FloatArray
    """Shape (d,): mean of the derivatives."""
    covariance: FloatArray
    """Shape (d, d): covariance of the derivatives. The diagonal is infinite for an unknown derivative."""


@dataclass(frozen=True)
class Posterior:
    """Mean and covariance of all p parameters of an axis."""

    theta: FloatArray
    """Shape (p,): mean in the order of ``names``."""
    covariance: FloatArray
    """Shape (p, p): covariance for given instruments. The diagonal is infinite for an unknown parameter."""
    common: FloatArray = field(default_factory=lambda: np.zeros((len(PARAMETERS), len(PARAMETERS))))
    """Shape (p, p): covariance due to the given instruments' errors, common to all estimates."""
    alpha_rad: tuple[float, float] = (nan, nan)
    """Lowest and highest measured angle of attack of the manoeuvre, rad. NaN without a measured angle of
    attack."""
    names: tuple[str, ...] = PARAMETERS
    """Names of the parameters. Names that end in ``_0`` are intercepts, which belong to single manoeuvres."""

    @property
    def std(self) -> FloatArray:
        """Shape (p,): standard deviations from both parts of the error."""
        return np.sqrt(np.diag(self.covariance) + np.diag(self.common))

    @cached_property
    def shared(self) -> Shared:
        """Mean and covariance of the derivatives alone."""
        derivatives, _ = _places(self.names)
        return Shared(self.theta[derivatives], self.covariance[np.ix_(derivatives, derivatives)])

    @cached_property
    def information(self) -> FloatArray:
        """Shape (d, d): information about the derivatives. Rows and columns of an unknown derivative are
        zero."""
        return information_of(self.shared.covariance)


def posteriors_at_one_speed(estimates: Sequence[Estimate]) -> list[Posterior]:
    """Return the estimates converted to their mean air speed, if every estimate has an air speed.

    Each parameter scales with its power of V (``SPEED_EXPONENTS``); gravity's part g/V of Z_0 is treated
    separately. Estimates at one speed, or without a speed, are unchanged. All manoeuvres share the residuals'
    colour, which comes from instruments and air. The factor on the Cramér-Rao bounds is therefore the median
    over the manoeuvres. Tests of aileron and rudder share no colour. A derivative by a control that a
    manoeuvre does not move comes from a prior, which is no evidence of the manoeuvre.
    """
    if not estimates:
        return []
    scale, values = _at_one_speed(estimates)
    powers = scale[:, :, None] * scale[:, None, :]
    return [
        Posterior(value, _of_data(e, covariance * power), e.common * power, _alpha_of(e), e.names)
        for e, value, covariance, power in zip(
            estimates, values, _covariances(estimates), powers, strict=True
        )
    ]


def _of_data(estimate: Estimate, covariance: FloatArray) -> FloatArray:
    """Return a covariance (p, p) in which parameters from a prior alone are unknown, and parameters that the
    user holds are known.
    """
    unknown = [estimate.names.index(name) for name in estimate.of_prior]
    if unknown:
        covariance = covariance.copy()
        covariance[unknown, :] = covariance[:, unknown] = 0.0
        covariance[unknown, unknown] = np.inf
    held = [estimate.names.index(name) for name in estimate.fixed]
    if held:
        covariance = covariance.copy()
        covariance[held, held] = (HELD * np.maximum(np.abs(estimate.theta[held]), 1.0)) ** 2
    return covariance


def _alpha_of(estimate: Estimate) -> tuple[float, float]:
    """Return the range of the measured angle of attack, rad; NaN without a measurement or a fit."""
    alpha = estimate.fits[0].get("alpha") if estimate.fits else None
    return (nan, nan) if alpha is None else (float(alpha.measured.min()), float(alpha.measured.max()))


def values_at_one_speed(estimates: Sequence[Estimate]) -> FloatArray:
    """Return the means of ``posteriors_at_one_speed``, shape (n, p)."""
    return _at_one_speed(estimates)[1]


def _at_one_speed(estimates: Sequence[Estimate]) -> tuple[FloatArray, FloatArray]:
    """Return factors on each estimate's parameters less gravity, and the parameters, both (n, p)."""
    theta, names = np.array([e.theta for e in estimates]), estimates[0].names
    reference = common_airspeed(estimates)
    if reference is None:
        return np.ones_like(theta), theta
    speeds = np.array([e.airspeed_m_s for e in estimates])[:, None]
    gravity = np.array([GRAVITY_M_S2 if name == "Z_0" else 0.0 for name in names])
    scale = (reference / speeds) ** np.array([SPEED_EXPONENTS[name] for name in names], dtype=float)
    values = (theta - gravity / speeds) * scale + gravity / reference
    held = [names.index(name) for name in estimates[0].fixed]
    scale[:, held], values[:, held] = 1.0, theta[:, held]
    return scale, values


def common_airspeed(estimates: Sequence[Estimate]) -> float | None:
    """Return the mean of the air speeds of the estimates; None where an estimate has none."""
    speeds = [e.airspeed_m_s for e in estimates if e.airspeed_m_s is not None and e.airspeed_m_s > 0.0]
    return float(np.mean(speeds)) if speeds and len(speeds) == len(estimates) else None


def _covariances(estimates: Sequence[Estimate]) -> FloatArray:
    """Return the covariances (n, p, p) for given instruments, with the colour of the residuals."""
    if not estimates[0].COLOUR_IS_SHARED:
        return np.array([e.own_covariance for e in estimates])
    plain = np.sqrt(np.array([np.diag(e.own_covariance_cr) for e in estimates]))
    corrected = np.sqrt(np.array([np.diag(e.own_covariance) for e in estimates]))
    usable = np.isfinite(plain) & np.isfinite(corrected) & (plain > 0.0)
    ratio = np.divide(corrected, plain, out=np.ones_like(plain), where=usable)
    median = np.median(ratio, axis=0)
    return np.array([e.own_covariance_cr * np.outer(median, median) for e in estimates])


def pool(posteriors: Sequence[Posterior]) -> Posterior:
    """Return the information-weighted mean of several estimates, each with separate intercepts.

    The derivatives are common to all estimates. Intercepts of the result are means over the manoeuvres. The
    intercepts of each manoeuvre are first corrected by the other manoeuvres' information on its derivatives.
    The instruments' error is common to all estimates, so more estimates do not average it out.

    Parameters
    ----------
    posteriors
        At least one estimate.
    """
    shared, names = _Summed.of(posteriors).pooled().shared, posteriors[0].names
    d, c = _places(names)
    n, values = len(posteriors), np.array([posterior.theta for posterior in posteriors])
    covariances = np.array([posterior.covariance for posterior in posteriors])
    cross = _finite(covariances[:, c][:, :, d])
    each = cross @ information_of(covariances[:, d][:, :, d])
    apart = _finite(shared.theta - values[:, d])
    gain = each.mean(axis=0)
    own = np.sum(covariances[:, c][:, :, c] - each @ np.swapaxes(cross, 1, 2), axis=0) / n**2
    theta, covariance = np.empty(len(names)), np.empty((len(names), len(names)))
    finite = _finite(shared.covariance)
    theta[d], theta[c] = shared.theta, np.mean(values[:, c] + np.einsum("nij,nj->ni", each, apart), axis=0)
    covariance[np.ix_(d, d)], covariance[np.ix_(c, c)] = shared.covariance, own + gain @ finite @ gain.T
    covariance[np.ix_(c, d)] = gain @ finite
    covariance[np.ix_(d, c)] = (gain @ finite).T
    return Posterior(theta, covariance, posteriors[-1].common, names=names)


def disagreement(estimate: Shared, other: Shared) -> tuple[float, int]:
    """Return the distance between two independent estimates of the derivatives.

    Returns
    -------
    tuple of float and int
        Squared Mahalanobis distance over the derivatives known to both, and their number. The distance is
        χ²-distributed with that many degrees of freedom if only noise separates both estimates.
    """
    return _distance(estimate.theta - other.theta, information_of(estimate.covariance + other.covariance))


class Pooled(NamedTuple):
    """Pooled estimate of the derivatives, and the scatter of the single estimates about it."""

    shared: Shared
    inconsistency: float
    """χ² of the single estimates about the pooled estimate."""
    dof: int
    """Degrees of freedom of χ²: those of the single estimates minus those of the pooled one."""


def pooled(posteriors: Sequence[Posterior]) -> Pooled:
    """Return the pooled estimate of at least one estimate."""
    return _Summed.of(posteriors).pooled()


def pooled_without_each(posteriors: Sequence[Posterior]) -> list[Pooled]:
    """Return, for each of at least two estimates, the pooled estimate of all others."""
    return _Summed.of(posteriors).without_each()


def pooled_on_both_sides(posteriors: Sequence[Posterior]) -> list[tuple[Pooled, Pooled]]:
    """Return the pooled estimates before and after each moment between two estimates."""
    return _Summed.of(posteriors).both_sides()


@dataclass(frozen=True, slots=True)
class _Summed:
    """Sums over estimates, from which the pooled estimate of any subset follows.

    χ² about the pooled value is Σ dᵢᵀIᵢdᵢ - vᵀCv with v = Σ Iᵢdᵢ and C = (Σ Iᵢ)⁻¹. Here d is the difference
    from a value near all estimates. Partial sums suffice, so pooling every part of a campaign costs little
    more than pooling the whole.
    """

    centre: FloatArray
    """Shape (d,): origin of the differences; 0 for an unknown derivative."""
    information: FloatArray
    """Shape (n, d, d): information Iᵢ of each estimate."""
    pull: FloatArray
    """Shape (n, d): products Iᵢdᵢ of the information and the estimate dᵢ."""
    own: FloatArray
    """Shape (n,): products dᵢᵀIᵢdᵢ of each estimate dᵢ and its information Iᵢ."""
    counts: FloatArray
    """Shape (n,): number of known derivatives in each estimate."""

    @classmethod
    def of(cls, posteriors: Sequence[Posterior]) -> "_Summed":
        d, _ = _places(posteriors[0].names)
        information = information_of(
            np.array([posterior.covariance for posterior in posteriors])[:, d][:, :, d]
        )
        theta = _finite(np.array([posterior.theta for posterior in posteriors])[:, d])
        total, weighted = information.sum(axis=0), np.einsum("nij,nj->i", information, theta)
        centre = _finite(covariance_of(total)) @ weighted
        apart = theta - centre
        pull = np.einsum("nij,nj->ni", information, apart)
        counts = np.count_nonzero(np.diagonal(information, axis1=1, axis2=2) > 0.0, axis=1)
        return cls(centre, information, pull, np.einsum("ni,ni->n", pull, apart), counts)

    def pooled(self) -> Pooled:
        return self._pooled(*(values.sum(axis=0, keepdims=True) for values in self._values()))[0]

    def without_each(self) -> list[Pooled]:
        # Sums before and after each entry lose no digits; the total less one entry would.
        return self._pooled(*(_before(values) + _after(values) for values in self._values()))

    def both_sides(self) -> list[tuple[Pooled, Pooled]]:
        before = self._pooled(*(_before(values)[1:] for values in self._values()))
        after = self._pooled(*(_after(values)[:-1] for values in self._values()))
        return list(zip(before, after, strict=True))

    def _values(self) -> tuple[FloatArray, ...]:
        return self.information, self.pull, self.own, self.counts

    def _pooled(
        self, information: FloatArray, pull: FloatArray, own: FloatArray, counts: FloatArray
    ) -> list[Pooled]:
        covariance = covariance_of(information)
        identified = np.isfinite(np.diagonal(covariance, axis1=1, axis2=2))
        moved = np.einsum("nij,nj->ni", _finite(covariance), pull)
        theta = np.where(identified, self.centre + moved, np.nan)
        chi2 = np.maximum(own - np.einsum("ni,ni->n", pull, moved), 0.0)
        dof = counts - identified.sum(axis=1)
        return [
            Pooled(Shared(theta[k], covariance[k]), float(chi2[k]), int(dof[k])) for k in range(len(theta))
        ]


def _before(values: FloatArray) -> FloatArray:
    """Return, for each entry along the first axis, the sum of the earlier entries."""
    return np.concatenate([np.zeros_like(values[:1]), np.cumsum(values, axis=0)[:-1]])


def _after(values: FloatArray) -> FloatArray:
    """Return, for each entry along the first axis, the sum of the later entries."""
    return _before(values[::-1])[::-1]


def _finite(values: FloatArray) -> FloatArray:
    """Return the values with zero in place of infinite ones."""
    return np.where(np.isfinite(values), values, 0.0)


def _distance(difference: FloatArray, information: FloatArray) -> tuple[float, int]:
    determined = np.isfinite(difference) & (np.diag(information) > 0.0)
    inside = np.where(determined, difference, 0.0)
    return float(inside @ information @ inside), int(determined.sum())
