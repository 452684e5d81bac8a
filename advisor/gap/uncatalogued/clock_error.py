"""Wrong values or wrong times: what a sensor without a named fault gets wrong.

A channel whose clock drifts or wanders is off by its own rate of change times a delay that is hardly ever the
same. A sensor that reads wrong is off by something else: its error does not vanish wherever
the channel turns round.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.stamps import rates_of

_LAG_OF = {"alpha": "alpha_lag"}
_MOSTLY = 0.5
"""Share of a channel's error, beyond its noise, that delays of each manoeuvre must explain."""
_BETTER = 2.0
"""How much more of it they must explain than a scale of each manoeuvre does."""


def is_clock_error(problem: Problem, fitted: Fitted, channel: str) -> bool:
    """Whether what is left of a channel is its rate times a delay that changes between manoeuvres.

    In each manoeuvre the delay may grow or shrink steadily. Where the channel was found to lag, it is the lag
    that changes: a sensor's.
    """
    if any(effect.effect == _LAG_OF.get(channel) for effect in fitted.point.effects):
        return False
    c = problem.channels.index(channel)
    delayed, scaled, total = 0.0, 0.0, 0.0
    for i, (flight, rates) in enumerate(zip(problem.flights.flights, rates_of(problem, fitted), strict=True)):
        rows = problem.rows(flight)[c]
        residual, measured = fitted.residuals[i][rows], flight.outputs[channel].y
        delayed += _taken(residual, rates[rows])
        scaled += _taken(residual, measured - np.mean(measured))
        total += float(residual @ residual)
        if problem.instruments is not None:
            total -= len(residual) * float(problem.instruments[c]) ** 2
    return delayed > _MOSTLY * total and delayed > _BETTER * scaled


def _taken(residual: FloatArray, times: FloatArray) -> float:
    """Sum of squares that a factor takes up which is constant or grows steadily over a manoeuvre."""
    basis = np.linalg.qr(np.column_stack([times, times * np.linspace(-1.0, 1.0, len(times))]))[0]
    return float(np.sum((basis.T @ residual) ** 2))
