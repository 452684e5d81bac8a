"""Residual power while the elevator moves, compared with that in quiet: noise does not depend on the
stick."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.problem import EffectProblem


def power_by_activity(
    problem: EffectProblem, residuals: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return the mean squares while the elevator moves, and while all is quiet; both of shape (channels,)."""
    sums, counts = np.zeros((2, len(problem.channels))), np.zeros((2, len(problem.channels)))
    for flight, residual in zip(problem.flights.flights, residuals, strict=True):
        free = flight.duration_s - flight.last_step_s
        for c, (name, rows) in enumerate(zip(problem.channels, problem.rows(flight), strict=True)):
            t = flight.outputs[name].t
            active = (t >= flight.first_step_s) & (t <= flight.last_step_s + 0.3 * free)
            for k, inside in enumerate((active, flight.is_quiet(t))):
                sums[k, c] += float(np.sum(residual[rows][inside] ** 2))
                counts[k, c] += np.count_nonzero(inside)
    active_power, quiet_power = sums / np.maximum(counts, 1.0)
    # Without a quiet stretch there is no comparison.
    return active_power, np.where(counts[1] > 0, quiet_power, active_power)
