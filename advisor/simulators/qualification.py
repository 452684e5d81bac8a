"""Published tolerance of the short period: 14 CFR Part 60, Appendix A, Table A2A, test 2.c.10.

Pitch within 1.5° or pitch rate within 2 °/s, and normal acceleration within 0.10 g, over the time history.
"""

from collections.abc import Sequence

import numpy as np

from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.result import Qualification
from advisor.gap.verdict.numbers import BAND, yardsticks
from advisor.process.arrays import FloatArray

_WINDOW_S = 0.1
"""Length of the moving average over an error, s. Shorter errors are instrument noise."""


def qualified(
    problem: EffectProblem, before: HeldOut, after: HeldOut | None, kept: Sequence[int]
) -> tuple[Qualification, ...]:
    """Return every channel compared with its tolerance.

    Parameters
    ----------
    before, after
        Residuals of the simulator as given, and with the effects; None if nothing was added.
    """
    table = []
    for c, channel in enumerate(problem.channels):
        was, theil_was = _error(problem, before, kept, c)
        now, theil_now = (None, None) if after is None else _error(problem, after, kept, c)
        limit = BAND.get(channel)
        table.append(
            Qualification(channel, None if limit is None else float(limit), was, now, (theil_was, theil_now))
        )
    return tuple(table)


def _error(problem: EffectProblem, held: HeldOut, kept: Sequence[int], c: int) -> tuple[float, float]:
    """Return the largest error in the channel's unit, averaged over the window, and Theil's coefficient."""
    largest = 0.0
    measured: list[FloatArray] = []
    simulated: list[FloatArray] = []
    for i in kept:
        flight = problem.flights.flights[i]
        out = flight.outputs[problem.channels[c]]
        residual = held.residuals[i][problem.rows(flight)[c]]
        largest = max(largest, float(np.max(np.abs(_averaged(out.t, residual)))))
        measured.append(out.y)
        simulated.append(out.y - residual)
    return largest, yardsticks(problem.channels[c], np.concatenate(measured), np.concatenate(simulated)).theil


def _averaged(t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the mean of the samples within the window around each stamp, both of shape (n,)."""
    first = np.searchsorted(t, t - 0.5 * _WINDOW_S, side="left")
    behind = np.searchsorted(t, t + 0.5 * _WINDOW_S, side="right")
    sums = np.concatenate([[0.0], np.cumsum(y)])
    return np.asarray((sums[behind] - sums[first]) / (behind - first))
