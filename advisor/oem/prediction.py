"""Accuracy of the predicted response: the 95 % band relative to the peak, for the estimate's own inputs.

Sensitivities of the outputs transfer the errors of derivatives and instruments to the response (delta
method). Trim, initial states and biases are refitted in every manoeuvre, so their errors do not count.
Correlated errors, such as those of a servo's lag and M_δe, cancel if they do not move the response.
"""

from collections.abc import Mapping

import numpy as np

from advisor.oem.arrow import unabsorbed
from advisor.oem.evaluation import Evaluated
from advisor.oem.gauss_newton import Optimum
from advisor.oem.rows import Laid
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95


def prediction_band(assembly: Laid, solution: Evaluated, covariance: FloatArray) -> Mapping[str, float]:
    """Return the widest prediction band of each output, by the output's name, as ``widest_bands`` does.

    Parameters
    ----------
    solution
        Optimum on the rows of ``assembly``.
    covariance
        Shape (p + k, p + k): covariance of the reported parameters and of the first k extra parameters.
    """
    names = assembly.names
    derivatives = [name for name in names.shared if name in names.reported]
    columns = solution.sensitivities[:, [names.shared.index(name) for name in derivatives]]
    kept = len(covariance) - len(names.reported)
    if kept and solution.extra is not None:
        columns = np.column_stack([columns, solution.extra.columns[:, :kept]])
    among = [*map(names.reported.index, derivatives), *range(len(names.reported), len(covariance))]
    return widest_bands(assembly, solution.optimum, columns, covariance[np.ix_(among, among)])


def widest_bands(
    assembly: Laid, optimum: Optimum, columns: FloatArray, covariance: FloatArray
) -> Mapping[str, float]:
    """Return the largest half-width of each output's 95 % band over the response's peak, by the output's
    name.

    Parameters
    ----------
    columns
        Shape (N, k): derivatives of the outputs by the parameters with errors.
    covariance
        Shape (k, k): covariance of these parameters.
    """
    weight = 1.0 / optimum.noise[assembly.channel]
    widest: dict[str, float] = {}
    for named, rows in zip(assembly.rows, assembly.blocks, strict=True):
        left = unabsorbed(columns[rows], optimum.sensitivities[rows][:, assembly.own], weight[rows], 1e-10)
        half = half_widths(left, covariance)
        for name, s in named.items():
            band = float(np.max(half[s.start - rows.start : s.stop - rows.start]))
            peak = float(np.max(np.abs(optimum.fitted[s] - optimum.fitted[s.start])))
            widest[name] = max(widest.get(name, 0.0), band / peak if peak > 0.0 else np.inf)
    return widest


def half_widths(slopes: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the half-width of a response's 95 % band, shape (n,), by the delta method.

    Parameters
    ----------
    slopes
        Shape (n, k): change of each sample with each parameter.
    covariance
        Shape (k, k): covariance of the parameters.
    """
    variance = np.einsum("ni,ni->n", slopes @ covariance, slopes)
    return np.asarray(NORMAL_95 * np.sqrt(np.maximum(variance, 0.0)))
