"""A sensor that jumps, for spikes, dropped bits or a loose plug."""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.robust import robust_std
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.records.floor import STATED_FLOOR_MARGIN

_FAR = 6.0
"""Least change between two samples of the residual, and least innovation, in standard deviations, that make a
jump."""
_JUMPS = 0.005
"""Least share of jumps among the samples for a jumping sensor."""


def jumping_sensor(problem: EffectProblem, last: EffectFit, tolerance: FloatArray) -> str | None:
    """Return the block of the only sensor that jumps where nothing is flown; None where none does.

    The residual of a model is smooth, the filter expects the residual of a gust, and no step of the command
    falls into quiet stretches. An autopilot's estimate of α is not judged. ``tolerance``, shape (channels,),
    is the assumed noise of filtered channels.
    """
    jumps = {}
    for c, name in enumerate(problem.channels):
        parts = []
        flights = zip(problem.flights.flights, last.residuals, last.innovations, strict=True)
        for flight, residual, innovations in flights:
            rows, t = problem.rows(flight)[c], flight.outputs[name].t
            quiet = flight.is_quiet(t)
            pair = np.column_stack([np.diff(residual[rows]), innovations[rows][1:]])
            parts.append(np.abs(pair[quiet[1:] & quiet[:-1]]))
        changes, surprises = np.concatenate(parts).T
        usual = [robust_std(y) if len(y) else 0.0 for y in (changes, surprises)]
        far = max(_FAR * usual[0], STATED_FLOOR_MARGIN * float(tolerance[c]))
        # Values that mostly repeat give no roughness.
        jumped = (changes > far) & (surprises > _FAR * usual[1])
        jumps[name] = float(np.mean(jumped)) if min(usual) > 0.0 else 0.0
    jumping = [name for name, share in jumps.items() if share >= _JUMPS]
    if len(jumping) != 1 or problem.channels.index(jumping[0]) not in problem.flights.telling:
        return None
    return next(block for block, channel in SENSOR_CHANNELS.items() if channel == jumping[0])
