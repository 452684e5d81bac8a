"""The aircraft file as prior of the derivatives.

Either the simulator's derivatives are right and an effect is missing, or they are off by tens of per cent.
Both cases have equal prior probability. Where the data leave a choice, such as a dead band or less elevator
power, the explanation that keeps the file's derivatives is likelier.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.effects import effect_named
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
_LOG_ODDS_OTHER_STATED = -4.0
"""Prior: log prior odds of an arm that the aircraft file states, relative to an equivalent arm that it leaves
open. They also hold for a vane's arm where α is an estimate."""


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


def log_prior(derivatives: FloatArray, covariance: FloatArray, prior: FloatArray) -> float:
    """Return the log probability density of fitted derivatives, given the aircraft file, up to a constant.

    Parameters
    ----------
    derivatives, covariance
        Shapes (6,) and (6, 6): fitted derivatives and their covariance.
    prior
        Shape (6,): derivatives of the aircraft file.
    """
    scale = derivative_scale(prior)
    densities = []
    for width in (ERROR_IF_RIGHT, ERROR_IF_WRONG):
        covariance_of_error = covariance / np.outer(scale, scale) + width**2 * np.eye(6)
        distance = _distance((derivatives - prior) / scale, covariance_of_error)
        densities.append(-0.5 * (distance + float(np.linalg.slogdet(covariance_of_error)[1])))
    return float(np.logaddexp(densities[0], densities[1]) - np.log(2.0))


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
    """Return the distance of fitted derivatives from the file's; ``log_prior`` has the arguments."""
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


def _distance(off: FloatArray, covariance_of_error: FloatArray) -> float:
    return float(off @ np.linalg.solve(covariance_of_error, off))


def log_odds_of_arm(name: str, arm_m: float, in_file: frozenset[str], alpha_is_derived: bool) -> float:
    """Return the log prior odds between the two arms that are equivalent in the data; 0 for other effects.

    ``in_file`` has the effects whose arm the aircraft file states.
    """
    effect = effect_named(name)
    if not effect.is_arm:
        return 0.0
    only_one_stated = len(in_file) == 1 and name in in_file
    no_vane = effect.channel == "alpha" and alpha_is_derived
    return (effect.log_odds_backward if arm_m < 0.0 else 0.0) + (
        _LOG_ODDS_OTHER_STATED if only_one_stated or no_vane else 0.0
    )
