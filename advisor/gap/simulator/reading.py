"""Simulated channels at the stamps of their measurements. The model is interpolated, never the data."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.simulator.layout import FILTERED
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel(error_model="numpy")
def read_rows(
    packs: FloatArray, h: float, stamps: FloatArray, output: np.ndarray, flown: np.ndarray, skews: FloatArray
) -> FloatArray:
    """Return all channels of one manoeuvre for many simulations at once.

    Parameters
    ----------
    packs
        Packs from ``advisor.gap.simulator.simulate.simulate``, with any number of lanes.
    h
        Time step of the simulation, s.
    stamps
        Shape (rows,).
    output
        Shape (rows,), int64: index of the output that each stamp reads.
    flown
        Shape (k,), int64: index of the simulation that each column reads. Columns may share a simulation.
    skews
        Shape (k, 4): time shift of each column and output in s; a positive shift makes the channel late.

    Returns
    -------
    Shape (rows, k).
    """
    k, last = len(flown), packs.shape[1] - 2
    pack, lane = flown // packs.shape[3], flown % packs.shape[3]
    y = np.empty((len(stamps), k))
    for i in range(len(stamps)):
        c = output[i]
        skew, at, part = np.inf, 0, 0.0
        for j in range(k):
            if skews[j, c] != skew:
                skew = skews[j, c]
                x = (stamps[i] - skew) / h
                at = min(max(int(x), 0), last)
                part = min(max(x - at, 0.0), 1.0)
            here = packs[pack[j], at, c, lane[j]]
            y[i, j] = here + part * (packs[pack[j], at + 1, c, lane[j]] - here)
    return y


@kernel(error_model="numpy")
def differences(read: FloatArray, measured: FloatArray, base: np.ndarray, step: FloatArray) -> FloatArray:
    """Return residuals and sensitivities, shape (rows, k), from readings of simulations.

    Parameters
    ----------
    read
        Shape (rows, k).
    measured
        Shape (rows,).
    base
        Shape (k,), int64: index of the column with the unperturbed simulation.
    step
        Shape (k,): finite-difference step of the column. A step of 0 marks an unperturbed simulation, whose
        residual is returned.
    """
    out = np.empty_like(read)
    for i in range(read.shape[0]):
        for j in range(read.shape[1]):
            if step[j] == 0.0:
                out[i, j] = measured[i] - read[i, j]
            else:
                out[i, j] = (read[i, j] - read[i, base[j]]) / step[j]
    return out


@kernel(error_model="numpy")
def _late(response: FloatArray, c: int, k: int, part: float) -> float:
    """Return an output ``k`` points and a ``part`` of a step after a response's start; 0 before the start."""
    here = response[c, k] if k >= 0 else 0.0
    before = response[c, k - 1] if k > 0 else 0.0
    return float((1.0 - part) * here + part * before)


@kernel(error_model="numpy")
def read_late(
    response: FloatArray,
    h: float,
    stamps: FloatArray,
    output: np.ndarray,
    skews: FloatArray,
    delays: FloatArray,
) -> FloatArray:
    """Return a response, shape (4, n + 1), delayed by each of ``delays`` in s and read like ``read_rows``.

    The delayed response is interpolated linearly to the points of the grid. ``skews`` has shape (4,), the
    result shape (rows, k).
    """
    last = response.shape[1] - 2
    y = np.empty((len(stamps), len(delays)))
    steps = np.maximum(delays, 0.0) / h
    for i in range(len(stamps)):
        c = output[i]
        x = (stamps[i] - skews[c]) / h
        at = min(max(int(x), 0), last)
        part = min(max(x - at, 0.0), 1.0)
        for j in range(len(delays)):
            first = int(steps[j])
            here = _late(response, c, at - first, steps[j] - first)
            y[i, j] = here + part * (_late(response, c, at + 1 - first, steps[j] - first) - here)
    return y


@kernel(error_model="numpy")
def _passed(out: complex, before: complex, here: complex, steps: complex, decay: complex) -> complex:
    """Return the output of a first-order pole at the end of a step in which its input moves linearly."""
    trail = steps * (here - before)
    return here - trail + decay * (out - before + trail)


@kernel(error_model="numpy")
def filtered(packs: FloatArray, h: float, flown: np.ndarray, filters: FloatArray) -> FloatArray:
    """Return simulations with a filter 1/(1 + T p + c T² p²) in one output each, as a pack for ``read_rows``.

    Parameters
    ----------
    packs, h, flown
        Arguments of ``read_rows``.
    filters
        Shape (k, 3), in the order of ``layout.FILTER``: T in s, the delay of a ramp; c, 0 for first order and
        1/2 for Butterworth; and the index of the output. A T of 0 means no filter.
    """
    k, n = len(flown), packs.shape[1]
    out = np.empty((1, n, 4, k))
    for j in range(k):
        pack, lane_of = flown[j] // packs.shape[3], flown[j] % packs.shape[3]
        for i in range(n):
            for c in range(4):
                out[0, i, c, j] = packs[pack, i, c, lane_of]
        late, shape = filters[j, FILTERED.filter_lag_s], max(filters[j, FILTERED.filter_shape], 1e-3)
        c = int(filters[j, FILTERED.filter_output])
        if late <= 0.0:
            continue
        # Two poles in series; below critical damping the poles are complex conjugates.
        split = np.sqrt(complex(1.0 - 4.0 * shape))
        one, other = late * (1.0 + split) / 2.0, late * (1.0 - split) / 2.0
        first, second = np.exp(-h / one), np.exp(-h / other)
        before = complex(out[0, 0, c, j])
        middle = last = before
        for i in range(1, n):
            here = complex(out[0, i, c, j])
            passed = _passed(middle, before, here, one / h, first)
            last = _passed(last, middle, passed, other / h, second)
            before, middle = here, passed
            out[0, i, c, j] = last.real
    return out


def packed(grids: Sequence[FloatArray]) -> FloatArray:
    """Return series on the grid, each of shape (4, n + 1), as one pack for ``read_rows``."""
    return np.ascontiguousarray(np.stack(grids, axis=-1).transpose(1, 0, 2))[None]


def lane(packs: FloatArray, k: int) -> FloatArray:
    """Return one simulation of a pack on its grid, shape (4, n + 1)."""
    pack, at = divmod(k, packs.shape[3])
    return np.ascontiguousarray(packs[pack, :, :, at].T)
