"""Uncertain stamps: how well the time of a sample is known, and what that does to its value.

A sample whose stamp is off by δt is off by δt times the rate at which its channel moves. That error is
white however smooth the motion, so it is read from the differences of the residual: the part of their
mean square that goes with the rate's square. Where a step of the command jerks the accelerometer, the time
is known no better than the simulation's grid.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.data import STEP_S
from advisor.gap.fit import Fitted
from advisor.gap.floor import white_noise
from advisor.gap.layout import OUTPUTS
from advisor.gap.problem import Problem
from advisor.gap.simulate import read_off

_CHANNEL = "q"
"""The pitch rate: smooth but quick, and measured by the best instrument on board."""
_THIRD = np.array([1.0, -3.0, 3.0, -1.0])
_BINS = 12
_MEDIAN = 0.455
"""Of the square of a standard normal number."""
_FAR = 2.0
"""Standard deviations of a stamp within which a sample may have been taken on the other side of a step."""
_LEAST = 0.3
"""Error of the pitch rate through its stamps, over its noise, from which on it counts."""


def stamp_variance(problem: Problem, fitted: Fitted) -> list[FloatArray]:
    """Per manoeuvre, shape (rows,): variance of each sample for not knowing quite when it was taken."""
    return [
        (problem.jitter_s * rate) ** 2 + 0.25 * jerk**2
        for rate, jerk in zip(rates_of(problem, fitted), _jerks_of(problem, fitted), strict=True)
    ]


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
    """Standard deviation of the stamps in s; 0 where the residual is no rougher when the channel moves."""
    c = problem.channels.index(_CHANNEL)
    power = float(np.sum(_THIRD**2))
    rough, moving = [], []
    for i, flight in enumerate(problem.flights.flights):
        rows = problem.rows(flight)[c]
        rough.append(np.convolve(fitted.left[i][rows], _THIRD, mode="valid") ** 2 / power)
        moving.append(np.convolve(rates[i][rows] ** 2, _THIRD**2, mode="valid") / power)
    y, x = np.concatenate(rough), np.concatenate(moving)
    # Medians over bins of equal count: a few differences are large for another reason, a step of the command.
    bins = np.array_split(np.argsort(x), _BINS)
    level = np.array([np.median(y[k]) for k in bins]) / _MEDIAN
    X = np.column_stack([np.ones(_BINS), [np.mean(x[k]) for k in bins]]) / level[:, None]
    variance = float(np.linalg.lstsq(X, np.ones(_BINS), rcond=None)[0][1])
    noise = white_noise(problem.flights)[_CHANNEL]
    return float(np.sqrt(variance)) if variance * float(np.mean(x)) > (_LEAST * noise) ** 2 else 0.0


def _read(problem: Problem, i: int, series: list[FloatArray]) -> FloatArray:
    """Series on the grid, one an output, at the stamps of each channel, stacked."""
    flight = problem.flights.flights[i]
    return np.concatenate(
        [read_off(series[OUTPUTS.index(c)], flight.h, flight.outputs[c].t, 0.0) for c in problem.channels]
    )
