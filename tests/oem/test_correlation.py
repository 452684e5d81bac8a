"""Correlations against answers that are known in closed form."""

import numpy as np
import pytest

from advisor.oem.correlation import correlation_matrix


def test_a_covariance_of_known_scale_gives_its_correlation():
    correlation = correlation_matrix(np.array([[4.0, 3.0], [3.0, 9.0]]))
    assert correlation == pytest.approx(np.array([[1.0, 0.5], [0.5, 1.0]]))


def test_a_parameter_without_variance_has_no_correlation():
    correlation = correlation_matrix(np.diag([0.0, 4.0]))
    assert np.isnan(correlation).tolist() == [[True, True], [True, False]]
