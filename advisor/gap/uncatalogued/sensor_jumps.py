"""A sensor that jumps: spikes, dropped bits, a plug that is loose."""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.flight.robust import robust_std
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.records.floor import STATED_FLOOR_MARGIN

_FAR, _SURPRISE = 6.0, 4.0
"""Standard deviations beyond which a change between two samples, and its innovation, are a jump ..."""
_JUMPS = 0.005
"""... share of them from which on a sensor jumps ..."""
_SELDOM = 0.1
"""... and what another sensor may have of that share."""
_OUT_OF_STEP, _MOSTLY_IN_STEP = 0.15, 0.5
"""Departure of an interval from the usual one at which a propeller's vibration, sampled at nearly the same
place of every turn, is met at another; and the share of intervals without, from which on only those count."""


def jumping_sensor(problem: Problem, last: Fitted, tolerance: FloatArray) -> str | None:
    """The block of the one sensor that jumps now and then where nothing is flown; None where none does.

    What a model leaves is smooth, and what a gust leaves is no surprise to a filter that knows of it; no
    step of the command falls into these stretches. An autopilot's estimate of α is not judged. Where samples
    come in step, those that do not are left out: there it is the vibration that jumps.
    ``tolerance``, shape (channels,), is what is called noise of channels that were filtered.
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
        # Values that mostly repeat say nothing about how rough they are.
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
    """Whether each interval is the usual one; all are where few would be."""
    intervals = np.diff(t)
    usual = np.median(intervals)
    in_step = np.abs(intervals - usual) < _OUT_OF_STEP * usual
    return in_step if np.mean(in_step) > _MOSTLY_IN_STEP else np.ones(len(intervals), dtype=bool)
