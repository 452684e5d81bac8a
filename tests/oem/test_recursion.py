"""The first-order recursion over samples, and sums that use it."""

import numpy as np
import pytest
from scipy.signal import lfilter

from advisor.oem.colour import Colour, powers, product
from advisor.oem.running_sums import accumulated


@pytest.mark.parametrize("shape", [(1, 1), (400, 1), (400, 5)])
@pytest.mark.parametrize("memory", [-0.4, 0.0, 0.6, 0.9995])
def test_samples_are_accumulated_as_by_a_recursive_filter(shape, memory):
    samples = np.random.default_rng(3).standard_normal(shape)
    expected = lfilter([1.0], [1.0, -memory], samples, axis=0)
    np.testing.assert_allclose(accumulated(samples, memory), expected, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_the_powers_are_the_diagonal_of_the_product(memory):
    rows = np.random.default_rng(4).standard_normal((50, 3))
    colour = Colour(2.0, memory, 0.5, np.eye(3))
    np.testing.assert_allclose(powers(rows, colour), np.diag(product(rows, colour)), rtol=1e-12)
