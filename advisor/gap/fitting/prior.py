"""What the aircraft file is worth as evidence.

Either the simulator's derivatives are right, and an effect is missing; or they are off, by tens of per
cent. Both are given the same chance beforehand. Where the data leave a choice (a dead-band or less
elevator power, M_α̇ or three other derivatives), what leaves the file's derivatives alone is likelier.
"""

from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray

ERROR_IF_RIGHT = 0.03
"""Relative error of derivatives that are right: linearised, at a nearby speed."""
ERROR_IF_WRONG = 0.3
"""Relative error of derivatives that are not."""
ERROR_IF_FIXED = 0.003
"""The same where they are held at the file's, to see what else would explain the motion."""
_LEAST = 0.1
"""Size below which a derivative is none, 1/s or 1/s²."""
_CHI_SQUARE_999, _CHI_SQUARE_500 = 22.46, 5.35
"""Of six degrees of freedom, exceeded once in a thousand times, and every other time."""

_LOG_ODDS_OTHER_STATED = -4.0
"""Log odds of an arm that the aircraft file states, against its twin that the file leaves open; and of a
vane's where the angle of attack is an estimate."""
_LOG_ODDS_BACKWARD = {"alpha_vane_offset": -5.0, "accelerometer_offset": -2.5}
"""Log odds of an arm that points backwards. The two are one and the same in the data; but a vane
behind the centre of gravity is hardly ever found, an accelerometer there less often than a vane ahead."""


def derivative_scale(prior: FloatArray) -> FloatArray:
    """Shape (6,): size of each derivative; Z_q beside 1, small ones beside the large ones."""
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
    """Shape (6,): inverse variances of the file's derivatives, given their relative error."""
    return np.asarray(1.0 / (tolerance * derivative_scale(prior)) ** 2)


def log_prior(derivatives: FloatArray, covariance: FloatArray, prior: FloatArray) -> float:
    """Log probability density of fitted derivatives, given the file, up to a constant.

    Parameters
    ----------
    derivatives, covariance
        Shapes (6,) and (6, 6): what was fitted, and how well it is known.
    believed
        Shape (6,): the file's.
    """
    scale = derivative_scale(prior)
    densities = []
    for width in (ERROR_IF_RIGHT, ERROR_IF_WRONG):
        covariance_of_error = covariance / np.outer(scale, scale) + width**2 * np.eye(6)
        distance = _distance((derivatives - prior) / scale, covariance_of_error)
        densities.append(-0.5 * (distance + float(np.linalg.slogdet(covariance_of_error)[1])))
    return float(np.logaddexp(densities[0], densities[1]) - np.log(2.0))


ARMS = frozenset(_LOG_ODDS_BACKWARD)
"""Effects that are an arm."""


@dataclass(frozen=True, slots=True)
class Distance:
    """How far fitted derivatives are from the file's, beside their tolerance and their errors."""

    statistic: float
    """Chi square of six degrees of freedom."""
    limit: float

    @property
    def is_off(self) -> bool:
        """Whether the file's cannot be right."""
        return self.statistic > self.limit


def distance_of(
    derivatives: FloatArray, covariance: FloatArray, prior: FloatArray, clear_gap: bool
) -> Distance:
    """How far fitted derivatives are from the file's.

    Arguments as ``log_prior``; where the file's ``clear_gap`` leave a gap, a smaller distance is enough.
    """
    scale = derivative_scale(prior)
    covariance_of_error = covariance / np.outer(scale, scale) + ERROR_IF_RIGHT**2 * np.eye(6)
    least = _CHI_SQUARE_500 if clear_gap else _CHI_SQUARE_999
    return Distance(_distance((derivatives - prior) / scale, covariance_of_error), least)


def _distance(off: FloatArray, covariance_of_error: FloatArray) -> float:
    return float(off @ np.linalg.solve(covariance_of_error, off))


def log_odds_of_arm(effect: str, arm_m: float, in_file: frozenset[str], alpha_is_derived: bool) -> float:
    """Log odds beforehand between the two arms that are one and the same in the data; 0 for other effects.

    ``in_file`` are the effects whose arm the file states.
    """
    if effect not in _LOG_ODDS_BACKWARD:
        return 0.0
    only_one_stated = len(in_file) == 1 and effect in in_file
    no_vane = effect == "alpha_vane_offset" and alpha_is_derived
    return (_LOG_ODDS_BACKWARD[effect] if arm_m < 0.0 else 0.0) + (
        _LOG_ODDS_OTHER_STATED if only_one_stated or no_vane else 0.0
    )
