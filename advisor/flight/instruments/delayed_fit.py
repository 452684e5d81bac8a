"""Least-squares fit of a signal as a sum of delayed signals: the delays, the factors, and their errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.coloured import coloured_covariance
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.motion import integrated

LONGEST_DELAY_S = 0.3
"""Longest delay in the search, s. Telemetry that is later shows as a gap or as a clock of its own."""
_STARTS_S = (0.0, 0.12, -0.12)
"""Delays, s, at which the search starts. They lie within half a period of the fastest short period of a small
aircraft (3 Hz) from any delay in the search."""
_ROUNDS = 15
_SETTLED_S = 1e-5
_LARGEST_STEP_S = 0.05
_FEWEST_SAMPLES = 20
_DRIFT = 2
"""Degree of the polynomial in time with which biases and slow errors enter an integral."""


@dataclass(frozen=True, slots=True)
class Summand:
    """Integral of a rate that enters the sum with an unknown delay."""

    t: FloatArray
    """Shape (n,), s."""
    rate: FloatArray
    """Shape (n,). The summand is its integral."""
    factor: float | None = None
    """Known factor. None: the factor is fitted."""


@dataclass(frozen=True, slots=True)
class DelayedFit:
    """Delays and factors of the summands, in their order."""

    delays_s: FloatArray
    """Shape (k,)."""
    delay_covariance: FloatArray
    """Shape (k, k), s². The residual may be coloured, or belong wholly to the delays."""
    factors: FloatArray
    """Shape (k,)."""
    factor_stds: FloatArray
    """Shape (k,), 0 for a known factor."""


def fit_delays(
    t: FloatArray, y: FloatArray, summands: Sequence[Summand], near_s: FloatArray | None = None
) -> DelayedFit | None:
    """Fit y(t) = Σ f·S(t − τ) + b_0 + b_1 t + b_2 t² by Gauss-Newton in the delays τ.

    Returns None where samples are too few, or where nothing moved.

    Parameters
    ----------
    t, y
        Shape (n,): stamps in s, and the signal.
    summands
        One or two summands, all on one grid of stamps.
    near_s
        Shape (k,): delays near the optimum, where they are known.
    """
    grid = summands[0].t
    inside = (t >= grid[0] + LONGEST_DELAY_S) & (t <= grid[-1] - LONGEST_DELAY_S)
    t, y = t[inside], y[inside]
    if len(t) < _FEWEST_SAMPLES:
        return None
    slow = np.vander((t - t.mean()) / np.ptp(t), _DRIFT + 1)
    shapes = [integrated(s.t, s.rate) for s in summands]
    if np.ptp(y) == 0.0 or any(np.ptp(s.rate) == 0.0 for s in summands):
        return None
    free = [i for i, s in enumerate(summands) if s.factor is None]
    known = np.array([s.factor if s.factor is not None else 0.0 for s in summands])
    best: tuple[float, FloatArray, FloatArray, FloatArray, FloatArray] | None = None
    starts = np.stack(np.meshgrid(*[_STARTS_S] * len(summands)), axis=-1).reshape(-1, len(summands))
    for start in starts if near_s is None else near_s[None]:
        delays = start.copy()
        for _ in range(_ROUNDS):
            columns = np.column_stack([
                np.interp(t - d, grid, shape) for d, shape in zip(delays, shapes, strict=True)
            ])  # fmt: skip
            rates = np.column_stack([
                np.interp(t - d, grid, s.rate) for d, s in zip(delays, summands, strict=True)
            ])  # fmt: skip
            linear = np.column_stack([columns[:, free], slow])
            fitted = np.linalg.lstsq(linear, y - columns @ known, rcond=None)[0]
            factors = known.copy()
            factors[free] = fitted[: len(free)]
            residual = y - columns @ known - linear @ fitted
            jacobian = np.column_stack([-factors * rates, linear])
            step = np.linalg.lstsq(jacobian, residual, rcond=None)[0][: len(delays)]
            step = np.clip(step, -_LARGEST_STEP_S, _LARGEST_STEP_S)
            if np.max(np.abs(step)) < _SETTLED_S:
                break
            delays = np.clip(delays + step, -LONGEST_DELAY_S, LONGEST_DELAY_S)
        cost = float(residual @ residual)
        if best is None or cost < best[0]:
            best = (cost, delays, factors, jacobian, residual)
    assert best is not None
    cost, delays, factors, jacobian, residual = best
    covariance = _covariance(jacobian, residual)
    k = len(delays)
    stds = np.zeros(k)
    stds[free] = np.sqrt(np.diag(covariance)[k : k + len(free)])
    return DelayedFit(delays, covariance[:k, :k], factors, stds)


def _covariance(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the covariance for coloured residuals, plus that of a residual that belongs to the parameters.

    An error of an instrument may have the shape of the motion, and a parameter then takes all of the
    residual. Such a parameter errs by at most ‖r‖·√((JᵀJ)⁻¹). The error is uniform up to this bound.
    """
    mistaken = float(residual @ residual) / 3.0 * np.linalg.pinv(jacobian.T @ jacobian)
    return np.asarray(coloured_covariance(jacobian, residual) + mistaken)
