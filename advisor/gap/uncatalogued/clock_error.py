"""Clock errors of a sensor, distinguished from errors of its values.

The error of a channel with a drifting clock is the channel's rate times a varying delay. An error of the
values does not vanish where the channel's rate is zero.
"""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.stamps import rates_of

_LAG_OF = {"alpha": "alpha_lag"}


def is_clock_error(problem: EffectProblem, fitted: EffectFit, channel: str) -> bool:
    """Return whether the residual of a channel is its rate times a delay that changes between manoeuvres.

    The delays must explain most of the error beyond noise, and more than a scale in each manoeuvre does. A
    delay may grow or shrink steadily within a manoeuvre. Where a lag of the channel was found, the lag
    itself changes, and the sensor is at fault.
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
    return delayed > max(total - delayed, scaled)


def _taken(residual: FloatArray, times: FloatArray) -> float:
    """Return the sum of squares explained by ``times`` with a factor that is linear in time over a
    manoeuvre."""
    basis = np.linalg.qr(np.column_stack([times, times * np.linspace(-1.0, 1.0, len(times))]))[0]
    return float(np.sum((basis.T @ residual) ** 2))
