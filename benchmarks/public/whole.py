"""Coefficients of the whole model from all training segments: by regression, then by output error.

Output error compares states that are simulated from the first measured one with the commands alone. Each
state counts over its root mean square range in the segments of the fit.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from advisor.process.arrays import FloatArray
from benchmarks.public.linear import FREE, ROWS, commands_of, factors, simulated
from benchmarks.public.segments import Segment, maneuver_of

EDGE = 6
"""Samples at each end of a segment that the regression skips: differences and filters are one-sided there."""
STEP = 1e-5
"""Step of a coefficient for a difference, over its size or a tenth: far above rounding of a simulation."""
FARTHEST = 50.0
"""Largest residual, ranges, with which a simulation that runs away counts."""
MOST_ITERATIONS = 30
"""Most simulations of the least squares, slopes not counted: the fit of the nine segments needs fewer."""


def regressed(train: Sequence[Segment]) -> tuple[FloatArray, Mapping[str, float]]:
    """Return coefficients (6, 11) by least squares on accelerations, and the share that each row explains."""
    known = np.concatenate([_factors(segment)[EDGE:-EDGE] for segment in train])
    wanted = np.concatenate([_accelerations(segment)[EDGE:-EDGE] for segment in train])
    coefficients = np.zeros(FREE.shape)
    shares = {}
    for i, row in enumerate(ROWS):
        of_row = known[:, FREE[i]]
        coefficients[i, FREE[i]] = np.linalg.lstsq(of_row, wanted[:, i], rcond=None)[0]
        residual = wanted[:, i] - known @ coefficients[i]
        shares[row] = float(1.0 - np.var(residual) / np.var(wanted[:, i]))
    return coefficients, shares


def _factors(segment: Segment) -> FloatArray:
    return factors(segment.states[:, 3:6], segment.states[:, 10:13], commands_of(segment))


def _accelerations(segment: Segment) -> FloatArray:
    """Return specific forces, m/s², and angular accelerations, rad/s², (n, 6)."""
    channels = maneuver_of(segment, 0).channels
    forces = np.column_stack([channels[name].y for name in ("a_x", "a_y", "a_z")])
    return np.column_stack([forces, np.gradient(segment.states[:, 10:13], segment.t, axis=0)])


def by_output_error(
    segments: Sequence[Segment], begun: FloatArray, free: NDArray[np.bool_] = FREE
) -> FloatArray:
    """Return the coefficients (6, 11) of least simulation error, from begun; those not free stay as begun."""
    size = np.sqrt(np.mean([np.ptp(segment.states, axis=0) ** 2 for segment in segments], axis=0))

    def models(values: FloatArray) -> FloatArray:
        found = np.repeat(begun[None], len(values), axis=0)
        found[:, free] = values
        return found

    def residuals(values: FloatArray) -> FloatArray:
        """Return the errors (k, m) of k sets of free coefficients."""
        each = [(simulated(models(values), segment) - segment.states) / size for segment in segments]
        joined = np.concatenate([e.reshape(len(values), -1) for e in each], axis=1)
        return np.asarray(np.clip(joined, -FARTHEST, FARTHEST))

    def alone(values: FloatArray) -> FloatArray:
        return np.asarray(residuals(values[None])[0])

    def slopes(values: FloatArray) -> FloatArray:
        steps = STEP * np.maximum(np.abs(values), 0.1)
        moved = residuals(np.vstack([values, values + np.diag(steps)]))
        return np.asarray(((moved[1:] - moved[0]) / steps[:, None]).T)

    found = least_squares(alone, begun[free], slopes, x_scale="jac", max_nfev=MOST_ITERATIONS)
    return np.asarray(models(found.x[None])[0])
