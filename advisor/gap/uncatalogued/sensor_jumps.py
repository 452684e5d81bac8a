"""A sensor that jumps, for spikes, dropped bits or a loose plug."""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.robust import robust_std
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.records.floor import STATED_FLOOR_MARGIN

_FAR, _SURPRISE = 6.0, 4.0
"""Least change between two samples, and least innovation, in standard deviations, that make a jump."""
_JUMPS = 0.005
"""Least share of jumps among the samples for a jumping sensor."""
_SELDOM = 0.1
"""Largest share of jumps in another sensor, relative to that of the jumping one."""
_OUT_OF_STEP, _MOSTLY_IN_STEP = 0.15, 0.5
"""Largest relative departure of an interval from the usual one, for samples in step; and least share of such
intervals for which others are ignored. A propeller's vibration, sampled at nearly one place of every turn,
jumps where the interval differs."""


def jumping_sensor(problem: EffectProblem, last: EffectFit, tolerance: FloatArray) -> str | None:
    """Return the block of the only sensor that jumps where nothing is flown; None where none does.

    The residual of a model is smooth, the filter expects the residual of a gust, and no step of the command
    falls into quiet stretches. An autopilot's estimate of α is not judged. Samples out of step are ignored
    where most are in step. ``tolerance``, shape (channels,), is the assumed noise of filtered channels.
    """
    jumps = {}
    for c, name in enumerate(problem.channels):
        parts = []
        flights = zip(problem.flights.flights, last.residuals, last.innovations, strict=True)
        for flight, residual, innovations in flights:
            rows, t = problem.rows(flight)[c], flight.outputs[name].t
            quiet, in_step = flight.is_quiet(t), _in_step(t)
            pair = np.column_stack([np.diff(residual[rows]), innovations[rows][1:]])
            parts.append(np.abs(pair[quiet[1:] & quiet[:-1] & in_step]))
        changes, surprises = np.concatenate(parts).T
        usual = [robust_std(y) if len(y) else 0.0 for y in (changes, surprises)]
        far = max(_FAR * usual[0], STATED_FLOOR_MARGIN * float(tolerance[c]))
        # Values that mostly repeat give no roughness.
        jumped = (changes > far) & (surprises > _SURPRISE * usual[1])
        jumps[name] = float(np.mean(jumped)) if min(usual) > 0.0 else 0.0
    worst = max(jumps, key=lambda name: jumps[name])
    others = [share for name, share in jumps.items() if name != worst]
    if jumps[worst] < _JUMPS or max(others, default=0.0) > _SELDOM * jumps[worst]:
        return None
    if problem.channels.index(worst) not in problem.flights.telling:
        return None
    return next(block for block, channel in SENSOR_CHANNELS.items() if channel == worst)


def _in_step(t: FloatArray) -> np.ndarray:
    """Return whether each interval is the usual one; all where few would be."""
    intervals = np.diff(t)
    usual = np.median(intervals)
    in_step = np.abs(intervals - usual) < _OUT_OF_STEP * usual
    return in_step if np.mean(in_step) > _MOSTLY_IN_STEP else np.ones(len(intervals), dtype=bool)
