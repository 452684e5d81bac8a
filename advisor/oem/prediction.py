"""Accuracy of the predicted response to the estimate's own inputs: the 95 % band relative to the peak.

Sensitivities of the outputs carry the errors of derivatives and estimated instruments to the response (delta
method). Trim, initial states and biases are refitted in every manoeuvre, so what they absorb is no error of
the prediction. Correlated errors, as a servo's lag and M_δe have, cancel where they move no response.
"""

from collections.abc import Mapping

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.oem.arrow import unabsorbed
from advisor.oem.evaluation import Evaluated
from advisor.oem.gauss_newton import Optimum
from advisor.oem.rows import Laid
from advisor.words.quantiles import NORMAL_95


def prediction_band(assembly: Laid, solution: Evaluated, covariance: FloatArray) -> Mapping[str, float]:
    """Return the band of a response by output name, as ``widest_bands``.

    Parameters
    ----------
    solution
        An optimum on the rows of ``assembly``.
    covariance
        (p + k, p + k) covariance of the reported parameters, and of the first k extra ones.
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
    """Return by output name the largest half-width of the 95 % band over the response's peak in all.

    Parameters
    ----------
    columns
        (N, k) derivatives of the outputs by the parameters that carry their errors to the response.
    covariance
        (k, k) covariance of these parameters.
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
    """Return half of the 95 % band of a response, shape (n,), by the delta method.

    Parameters
    ----------
    slopes
        (n, k) change of each sample with each parameter.
    covariance
        (k, k) covariance of the parameters.
    """
    variance = np.einsum("ni,ni->n", slopes @ covariance, slopes)
    return np.asarray(NORMAL_95 * np.sqrt(np.maximum(variance, 0.0)))
