"""Uncertain stamps: how well the time of a sample is known, and what that does to its value.

A sample whose stamp is off by δt is off by δt times the rate at which its channel moves. That error is
white however smooth the motion, so it is read from the differences of the residual: the part of their
mean square that goes with the rate's square. Where a step of the command jerks the accelerometer, the time
is known no better than the simulation's grid.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.records.grid import STEP_S
from advisor.gap.simulator.layout import ENTRIES

_LEAST = {"q": 0.3, "a_z": 0.45}
"""Channels that move quickly and are measured well; for each, from which error through its stamps on, beside
its noise, that error counts. The accelerometer is rough at every step of the command, stamps or not."""
_THIRD = np.array([1.0, -3.0, 3.0, -1.0])
_BINS = 12
"""Of the channel's rate, over which roughness is followed."""
_MEDIAN = 0.455
"""Of the square of a standard normal number."""
_FAR = 2.0
"""Standard deviations of a stamp within which a sample may have been taken on the other side of a step."""


def stamp_variance(problem: Problem, fitted: Fitted) -> list[FloatArray]:
    """Per manoeuvre, shape (rows,): variance of each sample for not knowing quite when it was taken."""
    return [
        (problem.jitter_s * rate) ** 2 + 0.25 * jerk**2
        for rate, jerk in zip(rates_of(problem, fitted), _jerks_of(problem, fitted), strict=True)
    ]


def stamp_power(problem: Problem, fitted: Fitted) -> FloatArray:
    """Shape (channels,): mean square that stamps which jitter add to each channel, whatever the model."""
    power = np.zeros(len(problem.channels))
    if problem.jitter_s == 0.0:
        return power
    for flight, rate in zip(problem.flights.flights, rates_of(problem, fitted), strict=True):
        power += [np.sum((problem.jitter_s * rate[rows]) ** 2) for rows in problem.rows(flight)]
    return np.asarray(power / counts(problem))


def rates_of(problem: Problem, fitted: Fitted) -> list[FloatArray]:
    """Per manoeuvre, shape (rows,): how fast each channel moves in the simulation at each stamp."""
    flights = problem.flights.flights
    return [
        _read(problem, i, [np.gradient(y, flights[i].h) for y in grid])
        for i, grid in enumerate(_flown(problem, fitted))
    ]


def _jerks_of(problem: Problem, fitted: Fitted) -> list[FloatArray]:
    """The same: by how much it departs from a straight line, as far as the stamps are uncertain."""
    reach = 0 if problem.jitter_s == 0.0 else 1 + int(_FAR * problem.jitter_s / STEP_S)
    return [
        _read(
            problem,
            i,
            [_largest_near(np.abs(np.diff(y, 2, prepend=y[0], append=y[-1])), reach) for y in grid],
        )
        for i, grid in enumerate(_flown(problem, fitted))
    ]


def _largest_near(y: FloatArray, reach: int) -> FloatArray:
    """Running maximum over ``reach`` steps to either side."""
    padded = np.pad(y, reach)
    return np.asarray(np.max([padded[k : k + len(y)] for k in range(2 * reach + 1)], axis=0))


def _flown(problem: Problem, fitted: Fitted) -> list[FloatArray]:
    p = problem.driving(fitted.point)
    return [problem.fly(flight, p[i]) for i, flight in enumerate(problem.flights.flights)]


def stamp_jitter(problem: Problem, fitted: Fitted, rates: list[FloatArray]) -> float:
    """Standard deviation of the stamps in s; 0 where no residual is rougher when its channel moves.

    Of several channels the one counts that is disturbed most beside its noise.
    """
    found = [_jitter_in(problem, fitted, rates, c) for c in _LEAST if c in problem.channels]
    exceeded, jitter_s = max(found)
    return jitter_s if exceeded > 1.0 else 0.0


def _jitter_in(
    problem: Problem, fitted: Fitted, rates: list[FloatArray], channel: str
) -> tuple[float, float]:
    """Power of what uncertain stamps do to a channel over the least that counts, and their deviation in s."""
    c = problem.channels.index(channel)
    power = float(np.sum(_THIRD**2))
    rough, moving = [], []
    for i, flight in enumerate(problem.flights.flights):
        rows = problem.rows(flight)[c]
        rough.append(np.convolve(fitted.residuals[i][rows], _THIRD, mode="valid") ** 2 / power)
        moving.append(np.convolve(rates[i][rows] ** 2, _THIRD**2, mode="valid") / power)
    y, x = np.concatenate(rough), np.concatenate(moving)
    # Medians over bins of equal count: a few differences are large for another reason, a step of the command.
    bins = np.array_split(np.argsort(x), _BINS)
    level = np.array([np.median(y[k]) for k in bins]) / _MEDIAN
    X = np.column_stack([np.ones(_BINS), [np.mean(x[k]) for k in bins]]) / level[:, None]
    variance = max(float(np.linalg.lstsq(X, np.ones(_BINS), rcond=None)[0][1]), 0.0)
    least = _LEAST[channel] * float(problem.flights.white[problem.channels.index(channel)])
    return variance * float(np.mean(x)) / least**2, float(np.sqrt(variance))


def _read(problem: Problem, i: int, series: list[FloatArray]) -> FloatArray:
    """Series on the grid, one an output, at the stamps of each channel, stacked."""
    return problem.read(problem.flights.flights[i], np.stack(series), np.zeros(len(ENTRIES)))
