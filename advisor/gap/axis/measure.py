"""Gap of an axis and its shrink, from sums of squared errors."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.axis.fit import Fit
from advisor.gap.axis.residual import noise_at_rest
from advisor.gap.fitting.measure import gap_between, shrink_between
from advisor.gap.result import Gap, Shrink
from advisor.process.arrays import FloatArray

_FLOOR_NOTE = "measured in the residual of the whole model"


def sums(fit: Fit, values: FloatArray) -> FloatArray:
    """Return the sums (m, outputs) of values (N,) over each manoeuvre and output."""
    total = np.zeros((fit.assembly.maneuvers, len(fit.noise)))
    np.add.at(total, (fit.assembly.owner, fit.assembly.channel), values)
    return total


def measured(
    fit: Fit, numbers: Sequence[int], before: FloatArray, after: FloatArray
) -> tuple[Gap, Shrink | None]:
    """Return the gap relative to the noise of a fit, and its shrink with the 95 % interval by resampling.

    Parameters
    ----------
    numbers
        Number of each manoeuvre.
    before, after
        Shape (m, outputs): sums of squared errors of the simulator and of the model. ``after`` is NaN for a
        manoeuvre that is not held out; the gap is that of the other manoeuvres.
    """
    counts = sums(fit, np.ones(len(fit.residual)))
    kept = np.flatnonzero(~np.isnan(after).all(axis=1))
    kept = kept if len(kept) else np.arange(len(after))
    seen = np.flatnonzero(counts[kept].sum(axis=0))
    # An output that was filtered before storage says nothing of its noise; moving air it does show.
    least = fit.assembly.least
    stated = least > fit.assembly.axis.least
    floor = np.maximum(least, noise_at_rest(fit)) if np.any(stated) else fit.noise
    floor = np.where(stated, floor, fit.noise)[seen]
    counts, squares = counts[:, seen], (before[:, seen], after[:, seen])
    whole = [x[kept].sum(axis=0) / counts[kept].sum(axis=0) for x in squares]
    with np.errstate(invalid="ignore"):  # a manoeuvre may lack an output
        was, now = (x / counts for x in squares)
    names = [fit.assembly.axis.outputs[k] for k in seen]
    gap = gap_between(names, numbers, floor, _FLOOR_NOTE, (whole[0], was), (whole[1], now))
    if not gap.before > 0.0 or np.isnan(gap.after):
        return gap, None
    there = np.all(counts > 0.0, axis=0)
    drawn = (x[kept][:, there] for x in (was, now))
    return gap, shrink_between(gap, np.array(numbers)[kept].tolist(), floor[there], *drawn)
