"""The aircraft file as prior of the derivatives.

Either the simulator's derivatives are right and an effect is missing, or they are off by tens of per cent.
Both cases have equal prior probability. Where the data leave a choice, such as a dead band or less elevator
power, the explanation that keeps the file's derivatives is likelier.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.model.response import SHARED
from advisor.oem.prior import precision_without_alpha

ERROR_IF_RIGHT = 0.03
"""Prior: relative standard deviation of derivatives that are right: they are linearised, at a nearby
speed."""
ERROR_IF_WRONG = 0.3
"""Prior: relative standard deviation of derivatives that are wrong."""
ERROR_IF_FIXED = 0.003
"""Prior: relative standard deviation of derivatives that are fixed at the file's, in the search for another
explanation."""
_LEAST = 0.1
"""Prior: least size of a derivative for a relative error, 1/s or 1/s². A smaller derivative counts as
zero."""


def derivative_scale(prior: FloatArray) -> FloatArray:
    """Return the size of each derivative, shape (6,): 1 for Z_q, and a share of the large derivatives for
    small ones."""
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
    found = precision_without_alpha(np.array([shared.get(name, 0.0) for name in SHARED]))
    return found[[SHARED.index(name) for name in DERIVATIVES]]


@dataclass(frozen=True, slots=True)
class Distance:
    """Distance of fitted derivatives from the aircraft file's, relative to prior error and covariance."""

    statistic: float
    """Squared distance from derivatives that are right; chi square with six degrees of freedom."""
    log_right: float
    """Log probability density, up to a constant, of the fitted derivatives where all of the file's hold."""
    log_wrong: float
    """Log probability density where some are wrong, each independently of the others. Both cases are alike
    likely before."""

    @property
    def log_odds(self) -> float:
        """Log odds, nats, of some wrong derivatives against none."""
        return self.log_wrong - self.log_right

    @property
    def is_off(self) -> bool:
        """Whether some of the file's derivatives are likelier wrong than all are right."""
        return self.log_odds > 0.0


def distance_of(derivatives: FloatArray, covariance: FloatArray, prior: FloatArray) -> Distance:
    """Return the distance of fitted derivatives from the file's.

    Parameters
    ----------
    derivatives, covariance
        Shapes (6,) and (6, 6): fitted derivatives and their covariance.
    prior
        Shape (6,): derivatives of the aircraft file.
    """
    scale = derivative_scale(prior)
    off, known = (derivatives - prior) / scale, covariance / np.outer(scale, scale)
    wrong = np.array(list(product((False, True), repeat=len(off))))
    widths = np.where(wrong, ERROR_IF_WRONG, ERROR_IF_RIGHT)
    errors = known + np.square(widths)[:, :, None] * np.eye(len(off))
    squares = np.linalg.solve(errors, np.broadcast_to(off, wrong.shape)[..., None])[..., 0] @ off
    each = 1.0 - 0.5 ** (1.0 / len(off))
    log_share = np.where(wrong, np.log(each), np.log(1.0 - each)).sum(axis=1)
    densities = log_share - 0.5 * (squares + np.linalg.slogdet(errors)[1])
    # The first set has no wrong derivative.
    return Distance(float(squares[0]), float(densities[0]), float(np.logaddexp.reduce(densities[1:])))
