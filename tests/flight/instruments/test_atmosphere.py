"""Density of the air flown in, and the true air speed by it."""

from collections.abc import Mapping

import numpy as np
import pytest

from advisor.flight.instruments.atmosphere import AirData, air_flown
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.channels import GIVEN_AIRSPEED
from advisor.flight.signals.record import Channel
from advisor.flight.signals.true_airspeed import standard_density, standard_pressure

SPAN = Span(0.0, 1.0, 2.0, 3.0, "3-2-1-1", (), "quiet")


def flown(values: Mapping[str, float], airspeed: str = "VFR_HUD.airspeed") -> Maneuver:
    t = np.arange(4.0)
    channels = {name: Channel(name, t, np.full(4, value)) for name, value in values.items()}
    return Maneuver(1, 0, SPAN, channels | {"airspeed": Channel("airspeed", t, np.full(4, 25.0), airspeed)})


@pytest.mark.parametrize(
    ("height_m", "pressure_pa", "density"),
    [
        (0.0, 101_325.0, 1.2250),
        (1000.0, 89_875.0, 1.1116),
        (1828.8, 81_200.0, 1.0239),
        (5000.0, 54_020.0, 0.7361),
    ],
)
def test_the_standard_atmosphere_is_the_tabulated_one(
    height_m: float, pressure_pa: float, density: float
) -> None:
    assert standard_pressure(height_m) == pytest.approx(pressure_pa, rel=1e-4)
    assert standard_density(pressure_pa) == pytest.approx(density, abs=1e-4)


def test_pressure_goes_before_the_height() -> None:
    found = air_flown([flown({"static_pressure": 89_875.0, "altitude": 50.0})])
    assert (found.source, round(found.density_kg_m3, 3)) == ("pressure", 1.112)


def test_a_given_temperature_makes_the_gas_law_of_pressure_or_height() -> None:
    by_pressure = air_flown([flown({"static_pressure": 90_000.0})], 26.85)
    assert (by_pressure.source, round(by_pressure.density_kg_m3, 4)) == ("pressure and temperature", 1.0451)
    by_height = air_flown([flown({"altitude": 1000.0})], 26.85)
    assert (by_height.source, round(by_height.density_kg_m3, 4)) == ("height and temperature", 1.0436)


def test_the_height_serves_where_the_pressure_is_that_of_no_air() -> None:
    found = air_flown([flown({"static_pressure": 0.0, "altitude": 1000.0})])
    assert (found.source, round(found.density_kg_m3, 3)) == ("height", 1.112)


def test_sea_level_is_said_where_nothing_is_logged() -> None:
    found = air_flown([flown({})])
    assert found.density_kg_m3 == 1.225
    assert "no pressure or height is logged" in found.sentence


def test_an_indicated_air_speed_is_raised_to_the_true_one_and_a_given_one_is_not() -> None:
    assert AirData(1.225 / 4.0, "height", "indicated").true_speed(25.0) == pytest.approx(50.0)
    given = air_flown([flown({"altitude": 3000.0}, GIVEN_AIRSPEED)])
    assert given.true_speed(25.0) == 25.0
