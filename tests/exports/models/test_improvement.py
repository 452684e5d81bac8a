"""What every format writes of an improved simulator, before any format."""

import pytest

from tests.exports.models.cases import MODEL, improvement


@pytest.mark.parametrize(
    ("height_m", "density"), [(None, 1.225), (0.0, 1.225), (1100.0, 1.1008), (5000.0, 0.7361)]
)
def test_the_density_is_that_of_the_standard_atmosphere_and_at_sea_level_without_a_height(height_m, density):
    """ICAO's standard atmosphere: 1.225 kg/m³ at sea level, 0.7361 kg/m³ at 5,000 m."""
    one = improvement(height_m=height_m)
    assert one.density_kg_m3 == pytest.approx(density, abs=1e-4)
    assert ("sea level" in one.density_note) is (height_m is None)


def test_a_prior_value_differs_outside_two_standard_deviations():
    """M_α is -41 with a standard deviation of 0.82, so that its 95 % interval ends 1.607 away."""
    one = improvement()
    assert one.interval95("M_alpha") == pytest.approx(
        (MODEL["M_alpha"] - 1.607, MODEL["M_alpha"] + 1.607), abs=1e-3
    )
    assert not one.differs("M_alpha", -42.5)
    assert one.differs("M_alpha", -42.7)
    assert one.differs("M_alpha", -39.3)
