"""Errors from dynamics that the model lacks, equal in all manoeuvres.

A true response differs from the model's by a relative error. A model error is equal in each manoeuvre, so
more manoeuvres do not average it out. The model error is a short filter on the model's outputs, with Gaussian
weights about zero. The variance of the weights is the most likely one for the residual. The change of the
parameters by such a filter is part of their covariance. The source is Goodwin, Gevers & Ninness, *IEEE
Transactions on Automatic Control* 37, 1992 (stochastic embedding).
"""

from collections.abc import Mapping

import numpy as np
from scipy.special import chdtri

from advisor.oem.colour import Colour
from advisor.oem.covariance import Weighing
from advisor.oem.extra import Extra
from advisor.oem.rows import Laid
from advisor.oem.scatter_between import CHANCE
from advisor.process.arrays import FloatArray

WIDTH_S, WEIGHTS = 0.2, 8
"""Numerical: distance between the filter's weights, s, and their number. The filter is linear between its
weights, and represents dynamics up to 2.5 Hz. Errors of the outputs above 2.5 Hz come from stamps and edges
of the input. Six flights of an autopilot determined the distance among 0.1, 0.2, 0.3 and 0.4 s. Of 26
intervals on four other flights 22 hold the truth, and 18 without model errors."""
_WITNESSES = 3
"""Numerical: least number of manoeuvres that can show a common error. On an axis with two controls, two of
three manoeuvres move one control."""
_SIZES = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 51)])
"""Numerical: candidate standard deviations of the filter's weights."""


def model_error(
    assembly: Laid,
    fitted: FloatArray,
    residual: FloatArray,
    g: FloatArray,
    extra: Extra | None,
    colours: Mapping[str, Colour],
    rows: FloatArray,
) -> FloatArray:
    """Return the covariance (p, p) of the parameters from dynamics that the model lacks.

    Parameters
    ----------
    fitted, residual
        Shape (N,): outputs of the model, and measured minus fitted outputs.
    g, extra
        Derivatives of the outputs, shape (N, s + l), and the fit's additional parameters.
    colours
        Noise model of each output, by the output's name.
    rows
        Shape (N, p): influence of the measurements on the parameters.
    """
    total = np.zeros((rows.shape[1], rows.shape[1]))
    if assembly.maneuvers < _WITNESSES:
        return total
    columns = g[:, assembly.common]
    if extra is not None:
        columns = np.column_stack([columns, extra.columns])
    basis = _filtered(assembly, fitted)
    white = Weighing.by(colours, assembly).forward(
        np.column_stack([g[:, assembly.own], columns, residual, basis])
    )
    own, columns, left, smooth = np.split(white, np.cumsum([len(assembly.own), columns.shape[1], 1]), axis=1)
    bases = [(block, directions(own[block])) for block in assembly.blocks]

    def without_own(part: FloatArray) -> FloatArray:
        """Return the part of the rows that the manoeuvres' own parameters do not absorb."""
        return np.concatenate([part[block] - mine @ (mine.T @ part[block]) for block, mine in bases])

    channels = np.unique(assembly.channel)
    only = [(assembly.channel == c)[:, None] for c in channels]
    common = directions(without_own(columns))
    seen = without_own(np.column_stack([left, *(np.where(mine, smooth, 0.0) for mine in only)]))
    seen -= common @ (common.T @ seen)
    for k, mine in enumerate(only):
        place = slice(1 + k * WEIGHTS, 1 + (k + 1) * WEIGHTS)
        moved = rows.T @ np.where(mine, basis, 0.0)
        total += _likeliest(seen[:, place], seen[:, 0]) ** 2 * moved @ moved.T
    return total


def directions(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the ``columns`` (n, k), shape (n, rank)."""
    left, sizes, _ = np.linalg.svd(
        columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False
    )
    return np.asarray(left[:, sizes > len(columns) * np.finfo(float).eps * np.max(sizes, initial=0.0)])


def _filtered(assembly: Laid, fitted: FloatArray) -> FloatArray:
    """Return the change of each output filtered by each weight's triangle, shape (N, weights)."""
    basis = np.zeros((len(fitted), WEIGHTS))
    for named in assembly.rows:
        for rows in named.values():
            t, y = assembly.t[rows], fitted[rows] - fitted[rows][0]
            smooth = _mean(t, y, 0)
            basis[rows] = np.array([_mean(t, smooth, k) for k in range(WEIGHTS)]).T
    return basis


def _mean(t: FloatArray, y: FloatArray, k: int) -> FloatArray:
    """Return the mean of ``y`` (n,), zero before its begin, from k + 1 to k widths before each stamp."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])
    late, later = (np.interp(t - WIDTH_S * lag, t, area, left=0.0) for lag in (k, k + 1))
    return np.asarray((late - later) / WIDTH_S)


def _likeliest(columns: FloatArray, residual: FloatArray) -> float:
    """Return the most likely standard deviation of the filter's weights; 0 if chance explains the
    residual."""
    powers, vectors = np.linalg.eigh(columns.T @ columns)
    powers = np.maximum(powers, 0.0)
    along = (vectors.T @ (columns.T @ residual)) ** 2
    whole = 1.0 + _SIZES[:, None] ** 2 * powers
    costs = np.sum(np.log(whole) - _SIZES[:, None] ** 2 * along / whole, axis=1)
    best = int(np.argmin(costs))
    # Without an error in common half of the gains are 0, and the others follow χ² of one degree of freedom.
    return float(_SIZES[best]) if -costs[best] > chdtri(1, 2.0 * CHANCE) else 0.0
