"""The band of a response counts what a manoeuvre's own parameters cannot absorb."""

import numpy as np
import pytest

from advisor.model.axis import Names
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.prediction import widest_bands
from advisor.oem.rows import Laid

N = 40
RAMP = np.linspace(0.0, 1.0, N)


def band(columns, own):
    """Return the band of one output that moves by 1, with an error of 1 in each of the shared parameters."""
    names = Names(("p",), ("shared",), ("trim",), ("shared",))
    laid = Laid(
        names=names, z=RAMP, t=RAMP, rows=({"p": slice(0, N)},), channel=np.zeros(N, np.int64),
        owner=np.zeros(N, np.int64), free=np.array([0, 1]),
    )  # fmt: skip
    sensitivities = np.column_stack([columns[:, 0], own])
    optimum = Optimum(
        CONVERGED, np.zeros(1), np.zeros((1, 1)), np.ones(1), 0.0, 1, fitted=RAMP, sensitivities=sensitivities
    )
    return widest_bands(laid, optimum, columns, np.eye(columns.shape[1]))["p"]


def test_what_a_trim_absorbs_is_no_error_of_the_response():
    assert band(np.full((N, 1), 0.1), np.ones(N)) == pytest.approx(0.0, abs=1e-9)


def test_what_no_trim_absorbs_is_an_error_over_the_peak():
    assert band(0.1 * RAMP[:, None], np.zeros(N)) == pytest.approx(0.196, rel=1e-3)


def test_the_error_of_an_instrument_counts_beside_that_of_a_derivative():
    columns = np.column_stack([0.1 * RAMP, 0.1 * RAMP])
    assert band(columns, np.zeros(N)) == pytest.approx(0.196 * np.sqrt(2.0), rel=1e-3)
