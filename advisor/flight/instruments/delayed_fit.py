"""Least-squares fit of a signal by delayed signals, with errors for coloured residuals.

An autopilot renews its servo outputs at one rate, and a stream samples them at another. Over 28 flights of
one autopilot the command acted 6 ms before to 10 ms after its linear reading, with stamps 20 ms apart. A
natural delay is no property of the aircraft. A delay of 10 ms that a model lacks changes M_q and M_δe by 7 to
19 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from advisor.flight.instruments.measured import Measured
from advisor.flight.signals.derived_alpha import integrated
from advisor.process.arrays import FloatArray

LONGEST_DELAY_S = 0.3
"""Longest delay in the search, s. A longer delay of telemetry appears as a gap or as a separate clock."""
_STARTS_S = (0.0, 0.12, -0.12)
"""Delays, s, at which the search starts. Every delay in the search is within half a period of the fastest
short period (3 Hz) of one of these starts."""
_FIRST_ROUNDS, _ROUNDS = 2, 15
"""Number of rounds of the search from each start, and from the best start."""
_SETTLED_S = 1e-5
_LARGEST_STEP_S = 0.05
_FEWEST_SAMPLES = 20
DRIFT = 2
"""Degree of the polynomial in time with which biases and slow errors enter an integral."""


@dataclass(frozen=True, slots=True)
class Summand:
    """Integral of a rate that is added to the sum with an unknown delay."""

    t: FloatArray
    """Shape (n,): stamps of the rate, s."""
    rate: FloatArray
    """Shape (n,): rate whose integral is the summand."""
    factor: float | None = None
    """Known factor of the summand. None if the factor is fitted."""


@dataclass(frozen=True, slots=True)
class DelayedFit:
    """Delays and factors of the summands, in their order."""

    delays_s: FloatArray
    """Shape (k,): delays of the summands, s."""
    delay_covariance: FloatArray
    """Shape (k, k): covariance of the delays, s². The covariance includes the effect of a coloured residual,
    and of a residual with the shape of the delays' effects.
    """
    factors: FloatArray
    """Shape (k,): factors of the summands."""
    factor_stds: FloatArray
    """Shape (k,): standard deviations of the factors, 0 for a known factor."""

    def factor(self, k: int = 0) -> Measured:
        return Measured(float(self.factors[k]), float(self.factor_stds[k]))

    @property
    def lateness(self) -> Measured:
        """Delay of the first summand relative to the sum, s."""
        return Measured(-float(self.delays_s[0]), float(np.sqrt(self.delay_covariance[0, 0])))


class _Point(NamedTuple):
    """State of the search for the delays."""

    delays: FloatArray
    factors: FloatArray
    jacobian: FloatArray
    residual: FloatArray

    @property
    def cost(self) -> float:
        return float(self.residual @ self.residual)


def fit_delays(
    t: FloatArray,
    y: FloatArray,
    summands: Sequence[Summand],
    near_s: FloatArray | None = None,
    drift: int = DRIFT,
) -> DelayedFit | None:
    """Fit y(t) = Σ f·S(t − τ) + b_0 + b_1 t + b_2 t² by Gauss-Newton in the delays τ.

    Return None if samples are too few, or if no summand moved.

    Parameters
    ----------
    t, y
        Shape (n,): stamps, s, and values of the signal.
    summands
        One or two summands, all at the same stamps.
    near_s
        Shape (k,): delays near the optimum, if known.
    drift
        Degree of the polynomial b in time.
    """
    grid = summands[0].t
    inside = (t >= grid[0] + LONGEST_DELAY_S) & (t <= grid[-1] - LONGEST_DELAY_S)
    t, y = t[inside], y[inside]
    if len(t) < _FEWEST_SAMPLES or np.ptp(y) == 0.0 or any(np.ptp(s.rate) == 0.0 for s in summands):
        return None
    slow = np.vander((t - t.mean()) / np.ptp(t), drift + 1)
    shapes = [integrated(s.t, s.rate) for s in summands]
    starts = np.stack(np.meshgrid(*[_STARTS_S] * len(summands)), axis=-1).reshape(-1, len(summands))
    looked = [
        _descended(t, y, slow, summands, shapes, start, _FIRST_ROUNDS)
        for start in (starts if near_s is None else near_s[None])
    ]
    nearest = min(looked, key=lambda point: point.cost)
    best = _descended(t, y, slow, summands, shapes, nearest.delays, _ROUNDS)
    covariance = _covariance(best.jacobian, best.residual)
    k = len(summands)
    free = [i for i, s in enumerate(summands) if s.factor is None]
    stds = np.zeros(k)
    stds[free] = np.sqrt(np.diag(covariance)[k : k + len(free)])
    return DelayedFit(best.delays, covariance[:k, :k], best.factors, stds)


def _descended(
    t: FloatArray,
    y: FloatArray,
    slow: FloatArray,
    summands: Sequence[Summand],
    shapes: Sequence[FloatArray],
    start: FloatArray,
    rounds: int,
) -> _Point:
    """Return the point that Gauss-Newton reaches from a start within some rounds."""
    grid, delays = summands[0].t, start.copy()
    free = [i for i, s in enumerate(summands) if s.factor is None]
    given = np.array([0.0 if s.factor is None else s.factor for s in summands])
    while True:
        shifted = [t - delay for delay in delays]
        columns = np.column_stack([np.interp(at, grid, s) for at, s in zip(shifted, shapes, strict=True)])
        rates = np.column_stack(
            [np.interp(at, grid, s.rate) for at, s in zip(shifted, summands, strict=True)]
        )
        linear = np.column_stack([columns[:, free], slow])
        fitted = np.linalg.lstsq(linear, y - columns @ given, rcond=None)[0]
        factors = given.copy()
        factors[free] = fitted[: len(free)]
        residual = y - columns @ given - linear @ fitted
        here = _Point(delays, factors, np.column_stack([-factors * rates, linear]), residual)
        if rounds == 0:
            return here
        step = np.linalg.lstsq(here.jacobian, residual, rcond=None)[0][: len(delays)]
        step = np.clip(step, -_LARGEST_STEP_S, _LARGEST_STEP_S)
        if np.max(np.abs(step)) < _SETTLED_S:
            return here
        delays = np.clip(delays + step, -LONGEST_DELAY_S, LONGEST_DELAY_S)
        rounds -= 1


def _covariance(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the parameters' covariance for coloured residuals, plus the covariance for a residual shaped
    like the motion.
    """
    # A parameter may absorb an error with the motion's shape, at most ‖r‖·√((JᵀJ)⁻¹), taken as uniform.
    mistaken = float(residual @ residual) / 3.0 * inverse_information(jacobian)
    return np.asarray(coloured_covariance(jacobian, residual) + mistaken)


_SMALLEST = 1e-15**0.5
"""Singular value of a Jacobian, over the largest, below which rounding errors dominate. JᵀJ then has the
precision of a double."""


def inverse_information(jacobian: FloatArray) -> FloatArray:
    """Return (JᵀJ)⁻¹ of a Jacobian (n, p), without the directions in which rounding errors dominate.

    The product of a root with itself has no negative variance, unlike the inverse of a nearly singular JᵀJ.
    """
    root = np.linalg.pinv(jacobian, rcond=_SMALLEST)
    return np.asarray(root @ root.T)


def coloured_covariance(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the covariance of a least-squares fit with coloured residuals.

    The covariance is (JᵀJ)⁻¹ (Σ_ij R(i−j) J_iᵀ J_j) (JᵀJ)⁻¹ with the residuals' autocovariance R (Klein &
    Morelli, Eq. 6.38 f.). R is tapered to zero at a fifth of the record.

    Parameters
    ----------
    jacobian
        Shape (n, p): Jacobian of the fit.
    residual
        Shape (n,): residuals at nearly equal time steps.
    """
    n = len(residual)
    inverse = inverse_information(jacobian)
    lags = max(1, n // 5)
    taper = 1.0 - np.arange(lags) / lags
    weights = taper * np.correlate(residual, residual, "full")[n - 1 : n - 1 + lags] / n
    both_sides = np.concatenate([weights[:0:-1], weights])
    smoothed = [np.convolve(column, both_sides)[lags - 1 : lags - 1 + n] for column in jacobian.T]
    inner = jacobian.T @ np.column_stack(smoothed)
    plain = float(residual @ residual) / max(n - jacobian.shape[1], 1) * inverse
    # The tapered sum may fall below the white-noise value by chance. Such a small value is not used.
    wider = np.sqrt(np.maximum(np.diag(inverse @ inner @ inverse) / np.maximum(np.diag(plain), 1e-300), 1.0))
    return np.asarray(plain * np.outer(wider, wider))


CLOCKS_S = 0.015
"""Standard deviation of a message's delay beyond its sampling interval, s: autopilot loop, transport,
filters. The value comes from 28 flights of one autopilot, -6 to +10 ms plus 4 to 20 ms of filters."""


def lateness_std(stamps: Sequence[FloatArray]) -> float:
    """Return the standard deviation of a channel's natural delay, s: half an interval plus ``CLOCKS_S``."""
    intervals = np.concatenate([np.diff(t) for t in stamps])
    return 0.5 * float(np.median(intervals)) + CLOCKS_S
