"""An air speed that reads low is wrong where the thin air at its height does not explain it."""

import pytest

from advisor.gap.uncatalogued.airspeed_scale import AirspeedScale
from advisor.gap.uncatalogued.weight_check import WeightReading


@pytest.mark.parametrize(("height_explains", "wrong"), [(0.30, False), (0.20, True), (0.0, True)])
def test_a_low_air_speed_is_wrong_where_the_height_does_not_explain_it(height_explains, wrong):
    weight_is_read_right = WeightReading(1.0, 0.004)
    assert AirspeedScale(0.31, 0.003).is_wrong(weight_is_read_right, height_explains) is wrong
