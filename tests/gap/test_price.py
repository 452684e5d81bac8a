"""The price of an effect is Schwarz's: half the logarithm of the samples for each of its numbers."""

import numpy as np
import pytest

from advisor.gap.kit.variant import Variant
from advisor.gap.search.score import price_of


def described_by(names, **fixed):
    size = len(names)
    return Variant(
        "gust", "air", names, ((0.0,) * size,), (1.0,) * size, ((-1.0, 1.0),) * size, 0.1, fixed=fixed
    )


@pytest.mark.parametrize(
    ("names", "fixed", "numbers"),
    [(("lag_s",), {}, 1), (("lag_s", "delay_s"), {}, 2), (("change",), {"at_s": 12.0}, 2)],
)
def test_each_number_costs_half_the_logarithm_of_the_samples(names, fixed, numbers):
    """A choice among variants counts as one number (Schwarz, *Annals of Statistics* 6, 1978)."""
    effective = np.array([300.0, 500.0, 200.0])
    price = price_of(described_by(names, **fixed), effective)
    assert price == pytest.approx(0.5 * numbers * np.log(1000.0))
