"""The covariance of a fit has no negative variance, however nearly two columns agree."""

import numpy as np
import pytest

from advisor.flight.instruments.delayed_fit import inverse_information


def nearly_equal_columns(seed: int) -> np.ndarray:
    """Return a Jacobian (300, 4) of two motions, each nearly twice."""
    rng = np.random.default_rng(seed)
    x, y, a, b = rng.standard_normal((4, 300))
    return np.column_stack([x, x + 1e-10 * a, 1e-3 * (x + y), 1e-3 * y + 1e-10 * b])


def test_no_variance_is_negative_where_columns_nearly_agree() -> None:
    for seed in range(100):
        assert np.all(np.diag(inverse_information(nearly_equal_columns(seed))) > 0.0)


def test_where_columns_differ_it_is_the_inverse() -> None:
    jacobian = np.random.default_rng(1).standard_normal((50, 3))
    unit = inverse_information(jacobian) @ (jacobian.T @ jacobian)
    assert unit == pytest.approx(np.eye(3), abs=1e-12)
