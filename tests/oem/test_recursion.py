"""The first-order recursion over samples."""

import numpy as np
import pytest
from scipy.signal import lfilter

from advisor.oem.colour import accumulated


@pytest.mark.parametrize("shape", [(1,), (400,), (400, 5)])
@pytest.mark.parametrize("memory", [-0.4, 0.0, 0.6, 0.9995])
def test_samples_are_accumulated_as_by_a_recursive_filter(shape, memory):
    samples = np.random.default_rng(3).standard_normal(shape)
    expected = lfilter([1.0], [1.0, -memory], samples, axis=0)
    np.testing.assert_allclose(accumulated(samples, memory), expected, rtol=0.0, atol=1e-9)
