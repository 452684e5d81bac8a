"""The air speed of a manoeuvre is the true one as far as the log tells it."""

from math import sqrt

import numpy as np
import pytest

from advisor.flight.signals.channels import GIVEN_AIRSPEED, TRUE_AIRSPEED, Decoded
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import BY_HEIGHT, BY_PRESSURE, is_true, standard_pressure, true_airspeed
from advisor.flight.signals.tracks import Tracks

T = np.arange(0.0, 5.0, 0.1)
LOGGED = Channel("airspeed", T, np.full(len(T), 20.0), "VFR_HUD.airspeed")
PRESSURE = Channel("static_pressure", T[::10], np.full(5, float(standard_pressure(3000.0))))
ALTITUDE = Channel("altitude", T[::10], np.full(5, 3000.0))
AT_3000_M = 20.0 / 0.8612
"""True air speed in the standard atmosphere at 3,000 m (density 0.9091 kg/m³)."""


def test_the_static_pressure_makes_an_air_speed_true() -> None:
    found = true_airspeed(LOGGED, PRESSURE, ALTITUDE, None)
    assert found.y == pytest.approx(AT_3000_M, rel=1e-3)
    assert found.source == f"VFR_HUD.airspeed{BY_PRESSURE}"
    assert is_true(found)


def test_the_height_serves_without_a_plausible_pressure() -> None:
    for pressure in (None, Channel("static_pressure", T, np.zeros(len(T)))):
        found = true_airspeed(LOGGED, pressure, ALTITUDE, None)
        assert found.y == pytest.approx(AT_3000_M, rel=1e-3)
        assert found.source == f"VFR_HUD.airspeed{BY_HEIGHT}"


def test_a_given_temperature_replaces_the_standard_one() -> None:
    """Warm air is thinner: 10 K of 269 K make 1.8 % of speed."""
    found = true_airspeed(LOGGED, PRESSURE, None, -4.5 + 10.0)
    assert found.y == pytest.approx(AT_3000_M * sqrt(278.65 / 268.65), rel=1e-3)


def test_without_pressure_and_height_an_air_speed_stays_as_logged() -> None:
    zero = Channel("altitude", T, np.zeros(len(T)))
    for altitude in (None, zero):
        found = true_airspeed(LOGGED, None, altitude, None)
        assert found is LOGGED
        assert not is_true(found)


@pytest.mark.parametrize("source", [GIVEN_AIRSPEED, TRUE_AIRSPEED])
def test_a_true_air_speed_stays_as_it_is(source: str) -> None:
    logged = Channel("airspeed", T, np.full(len(T), 20.0), source)
    assert true_airspeed(logged, PRESSURE, ALTITUDE, None) is logged


def filled(**tracks: bool) -> Tracks:
    """Tracks with an air speed of 20 m/s at 3,000 m."""
    found = Tracks("auto", logs_true_speed=lambda: tracks.get("true", False))
    for channel, source, value in (
        ("airspeed", "VFR_HUD.airspeed", 20.0),
        ("altitude", "GLOBAL_POSITION_INT.alt", 3000.0),
        ("climb_rate", "VFR_HUD.climb", 2.0),
        ("theta", "ATTITUDE.pitch", 0.2),
    ):
        found.append(Decoded(channel, source, "measured", T, np.full(len(T), value), np.arange(len(T))))
    return found


def test_the_vehicles_air_speed_is_made_true() -> None:
    speed = filled().cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.y == pytest.approx(AT_3000_M, rel=1e-3)


def test_a_derived_angle_of_attack_uses_the_true_air_speed() -> None:
    alpha = filled().cut("alpha", 0.0, 5.0)
    assert alpha is not None
    assert alpha.y == pytest.approx(0.2 - np.arcsin(2.0 / AT_3000_M), rel=1e-3)


def test_a_vehicle_that_reports_its_true_air_speed_is_believed() -> None:
    speed = filled(true=True).cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.y.tolist() == [20.0] * len(T)


def test_the_altitude_of_the_hud_serves_where_no_position_is_logged() -> None:
    found = Tracks("auto")
    for channel, source, value in (
        ("airspeed", "VFR_HUD.airspeed", 20.0), ("altitude", "VFR_HUD.alt", 3000.0),
    ):  # fmt: skip
        found.append(Decoded(channel, source, "measured", T, np.full(len(T), value), np.arange(len(T))))
    speed = found.cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.y == pytest.approx(AT_3000_M, rel=1e-3)


def test_the_aircraft_files_height_serves_where_the_log_has_none() -> None:
    found = Tracks("auto", height_m=3000.0)
    found.append(Decoded("airspeed", "VFR_HUD.airspeed", "measured", T, np.full(len(T), 20.0), np.arange(50)))
    speed, altitude = found.cut("airspeed", 0.0, 5.0), found.cut("altitude", 0.0, 5.0)
    assert speed is not None
    assert altitude is not None
    assert speed.y == pytest.approx(AT_3000_M, rel=1e-3)
    assert altitude.provenance == "given"


def test_an_air_speed_that_is_the_ground_speed_in_every_sample_is_no_indicated_one() -> None:
    found = Tracks("auto")
    for channel, source, values in (
        ("airspeed", "VFR_HUD.airspeed", 20.0 + T), ("groundspeed", "VFR_HUD.groundspeed", 20.0 + T),
        ("altitude", "VFR_HUD.alt", np.full(len(T), 3000.0)),
    ):  # fmt: skip
        found.append(Decoded(channel, source, "measured", T, values, np.arange(len(T))))
    speed = found.cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.y.tolist() == (20.0 + T).tolist()
    assert is_true(speed)


def test_a_pressure_that_stands_still_is_a_default_and_the_height_makes_the_air_speed_true() -> None:
    found, t = filled(), T[::10]
    found.append(
        Decoded("static_pressure", "HIGHRES_IMU.abs_pressure", "measured", t, np.full(5, 95e3), np.arange(5))
    )
    speed = found.cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.source == f"VFR_HUD.airspeed{BY_HEIGHT}"
    assert speed.y == pytest.approx(AT_3000_M, rel=1e-3)


def test_an_aircraft_with_a_static_pressure_reports_no_true_air_speed() -> None:
    found, pressure = filled(true=True), 70e3 + 10.0 * T
    found.append(
        Decoded("static_pressure", "SCALED_PRESSURE.press_abs", "measured", T, pressure, np.arange(len(T)))
    )
    speed = found.cut("airspeed", 0.0, 5.0)
    assert speed is not None
    assert speed.source == f"VFR_HUD.airspeed{BY_PRESSURE}"
