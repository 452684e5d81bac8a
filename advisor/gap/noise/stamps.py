"""Uncertain stamps: the time error of samples, and the error that follows in their values.

A stamp with an error δt makes an error of δt times the rate of the channel. The error from wrong stamps is
white, however smooth the motion is. The part of the residual differences' mean square that grows with the
squared rate is due to wrong stamps. At a step of the command the time of the acceleration is known no better
than the simulation's grid.
"""

import numpy as np
from scipy.ndimage import maximum_filter1d

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.records.airspeed import STEP_S
from advisor.gap.simulator.layout import ENTRIES
from advisor.process.arrays import FloatArray

_LEAST = {"q": 0.3, "a_z": 0.45}
"""Least error from wrong stamps relative to the noise, by channel, above which stamps count as uncertain.
Only channels that change quickly and have little noise are used. The accelerometer's limit is higher, because
its signal is rough at every step of the command."""
_BINS = 12
"""Numerical: number of bins of a channel's rate for the dependence of the roughness on the rate."""
_MEDIAN = 0.455
"""Numerical: median of the square of a standard normal number."""
_FAR = 2.0
"""Numerical: number of a stamp's standard deviations within which a sample may lie across a step."""


def stamp_variance(problem: EffectProblem, fitted: EffectFit) -> list[FloatArray]:
    """Return the variance of each sample due to its uncertain stamp, per manoeuvre, shape (rows,)."""
    return [
        (problem.jitter_s * rate) ** 2 + 0.25 * jerk**2
        for rate, jerk in zip(rates_of(problem, fitted), _jerks_of(problem, fitted), strict=True)
    ]


def stamp_power(problem: EffectProblem, fitted: EffectFit) -> FloatArray:
    """Return the mean square that jitter of the stamps adds to each channel, shape (channels,)."""
    power = np.zeros(len(problem.channels))
    if problem.jitter_s == 0.0:
        return power
    for flight, rate in zip(problem.flights.flights, rates_of(problem, fitted), strict=True):
        power += [np.sum((problem.jitter_s * rate[rows]) ** 2) for rows in problem.rows(flight)]
    return np.asarray(power / counts(problem))


def rates_of(problem: EffectProblem, fitted: EffectFit) -> list[FloatArray]:
    """Return per manoeuvre, shape (rows,): rate of each channel in the simulation at each stamp."""
    flights = problem.flights.flights
    return [
        _read(problem, i, [np.gradient(y, flights[i].h) for y in grid])
        for i, grid in enumerate(_flown(problem, fitted))
    ]


def _jerks_of(problem: EffectProblem, fitted: EffectFit) -> list[FloatArray]:
    """Return per manoeuvre, shape (rows,): largest deviation from a line within the stamps' uncertainty."""
    reach = 0 if problem.jitter_s == 0.0 else 1 + int(_FAR * problem.jitter_s / STEP_S)
    return [
        _read(
            problem,
            i,
            [maximum_filter1d(abs(np.diff(y, 2, prepend=y[0], append=y[-1])), 2 * reach + 1) for y in grid],
        )
        for i, grid in enumerate(_flown(problem, fitted))
    ]


def _flown(problem: EffectProblem, fitted: EffectFit) -> list[FloatArray]:
    p = problem.driving(fitted.point)
    return [problem.fly(flight, p[i]) for i, flight in enumerate(problem.flights.flights)]


def stamp_jitter(problem: EffectProblem, fitted: EffectFit, rates: list[FloatArray]) -> float:
    """Return the standard deviation of the stamps, s; 0 if no residual gets rougher with the channel's rate.

    The channel with the largest error relative to its noise decides.
    """
    by_channel = [_jitter_in(problem, fitted, rates, c) for c in _LEAST if c in problem.channels]
    exceeded, jitter_s = max(by_channel)
    return jitter_s if exceeded > 1.0 else 0.0


def _jitter_in(
    problem: EffectProblem, fitted: EffectFit, rates: list[FloatArray], channel: str
) -> tuple[float, float]:
    """Return the ratio of stamp error power to its limit, and the stamp errors' std, s."""
    c = problem.channels.index(channel)
    third = np.array([1.0, -3.0, 3.0, -1.0])  # weights of a third difference
    power = float(np.sum(third**2))
    rough, moving = [], []
    for i, flight in enumerate(problem.flights.flights):
        rows = problem.rows(flight)[c]
        rough.append(np.convolve(fitted.residuals[i][rows], third, mode="valid") ** 2 / power)
        moving.append(np.convolve(rates[i][rows] ** 2, third**2, mode="valid") / power)
    y, x = np.concatenate(rough), np.concatenate(moving)
    # Medians over bins of equal count: a step of the command makes a few differences large for another
    # reason.
    bins = np.array_split(np.argsort(x), _BINS)
    level = np.array([np.median(y[k]) for k in bins]) / _MEDIAN
    X = np.column_stack([np.ones(_BINS), [np.mean(x[k]) for k in bins]]) / level[:, None]
    variance = max(float(np.linalg.lstsq(X, np.ones(_BINS), rcond=None)[0][1]), 0.0)
    least = _LEAST[channel] * float(problem.flights.white[problem.channels.index(channel)])
    return variance * float(np.mean(x)) / least**2, float(np.sqrt(variance))


def _read(problem: EffectProblem, i: int, series: list[FloatArray]) -> FloatArray:
    """Return series on the time grid, one per output, at the stamps of each channel, stacked."""
    return problem.read(problem.flights.flights[i], np.stack(series), np.zeros(len(ENTRIES)))
