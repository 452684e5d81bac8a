"""Flight-test validation by the scatter of the last estimates, Eqs. (12) and (13) of the paper."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan, Criterion
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.pooling import values_at_one_speed
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import Estimate

SCATTER_FACTOR = 5.0
"""Factor of σ in Eq. (12). The factor belongs to this rule only; a calibrated σ is never multiplied by it."""


def scatter_by_parameter(theta: FloatArray, criterion: Criterion = "eq12") -> FloatArray:
    """Return the scatter of each parameter over a window of estimates, relative to its mean.

    Parameters
    ----------
    theta
        Shape (n, 8). The estimates of the last n accepted manoeuvres, one a row.
    criterion
        ``eq12``: 5·σ/|θ̄| with the sample standard deviation (n − 1 in its denominator).
        ``eq13``: 5·Σ(θ̂ − θ̄)²/(n·|θ̄|), the form that the paper prints. This form is not dimensionless
        and so depends on the units of the parameters (rad and s here).

    Returns
    -------
    FloatArray
        Shape (8,). Infinite where the mean is exactly zero.
    """
    mean = theta.mean(axis=0)
    spread = theta.std(axis=0, ddof=1) if criterion == "eq12" else theta.var(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = SCATTER_FACTOR * spread / np.abs(mean)
    return np.where(spread == 0.0, 0.0, relative)


def scatter_percent(theta: FloatArray, criterion: Criterion = "eq12") -> float:
    """Return the stop criterion: Euclidean norm over the eight parameters of `scatter_by_parameter`, in
    percent.

    The norm takes absolute values, so the sign of a parameter's mean does not matter.
    """
    return 100.0 * float(np.linalg.norm(scatter_by_parameter(theta, criterion)))


def scattered_most(theta: FloatArray, criterion: Criterion = "eq12") -> str:
    """Return the parameter that contributes most to `scatter_percent`. A parameter without a value comes
    first."""
    return PARAMETERS[int(np.argmax(np.nan_to_num(scatter_by_parameter(theta, criterion), nan=np.inf)))]


def window(accepted: Sequence[Estimate], plan: CampaignPlan) -> FloatArray | None:
    """Return the last n accepted estimates at one air speed, shape (n, 8); None for fewer than n."""
    if len(accepted) < plan.window:
        return None
    return values_at_one_speed(accepted[-plan.window :])
