"""Density of the air flown in, and the true air speed by it."""

from collections.abc import Mapping

import numpy as np
import pytest

from advisor.flight.instruments.atmosphere import AirData, air_flown
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.channels import GIVEN_AIRSPEED
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import standard_density, standard_pressure
from tests.rows import row

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
def test_the_standard_atmosphere_is_the_tabulated_one(height_m, pressure_pa, density):
    assert standard_pressure(height_m) == pytest.approx(pressure_pa, rel=1e-4)
    assert standard_density(pressure_pa) == pytest.approx(density, abs=1e-4)


NO_AIR = {"static_pressure": 0.0, "altitude": 1000.0}
PRESSURE = {"static_pressure": 90_000.0}
BOTH = {"static_pressure": 89_875.0, "altitude": 50.0}


@row(
    "pressure goes before the height",
    {"static_pressure": 89_875.0, "altitude": 50.0}, None, "pressure", 1.1116,
)  # fmt: skip
@row("a temperature makes the gas law of the pressure", PRESSURE, 26.85, "pressure and temperature", 1.0451)
@row(
    "a temperature makes the gas law of the height",
    {"altitude": 1000.0}, 26.85, "height and temperature", 1.0436,
)  # fmt: skip
@row("the height serves where the pressure is that of no air", NO_AIR, None, "height", 1.1116)
def test_the_density_comes_from(values, celsius: float | None, source: str, density: float) -> None:
    found = air_flown([flown(values)], celsius)
    assert (found.source, round(found.density_kg_m3, 4)) == (source, density)


def test_sea_level_is_said_where_nothing_is_logged() -> None:
    found = air_flown([flown({})])
    assert found.density_kg_m3 == 1.225
    assert "no pressure or height is logged" in found.sentence


def test_an_indicated_air_speed_is_raised_to_the_true_one_and_a_given_one_is_not() -> None:
    assert AirData(1.225 / 4.0, "height", "indicated").true_speed(25.0) == pytest.approx(50.0)
    given = air_flown([flown({"altitude": 3000.0}, GIVEN_AIRSPEED)])
    assert given.true_speed(25.0) == 25.0
