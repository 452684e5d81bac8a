"""Which VFR_HUD promise an angle of attack by climb rate and air speed."""

import numpy as np
import pytest

from advisor.flight.signals.derived_alpha import derived_alpha, promised
from tests.flight.columns import Wire

FAST, ROLLS, STANDS = (20.0, 21.0), (1.0, 8.0), (1.0, 2.0)
"""Air speed and speed over ground, m/s; the aircraft flies above 4 m/s."""


def huds(*speeds, **left_out):
    """Return VFR_HUD of these speeds in this order, without some fields."""
    wire = Wire()
    for k, (airspeed, groundspeed) in enumerate(speeds):
        fields = {"airspeed": airspeed, "groundspeed": groundspeed, "climb": 0.5}
        wire.send("VFR_HUD", float(k), **{n: v for n, v in fields.items() if n not in left_out})
    (columns,) = wire.columns()
    return columns


def test_a_rolling_aircraft_without_air_speed_gives_no_angle_and_a_standing_one_will():
    assert promised(huds(FAST, ROLLS, STANDS), None).tolist() == [0, 2]


@pytest.mark.parametrize(("speed", "count"), [(3.9, 0), (4.1, 1)])
def test_an_aircraft_flies_above_four_metres_a_second(speed, count):
    assert len(promised(huds((speed, 10.0)), None)) == count


def test_without_a_climb_rate_there_is_no_angle():
    assert len(promised(huds(FAST, climb=True), 20.0)) == 0


def test_where_no_air_speed_is_recorded_or_one_is_stated_all_of_them_give_an_angle():
    assert len(promised(huds(FAST, ROLLS, airspeed=True), None)) == 2
    assert len(promised(huds(FAST, ROLLS), 20.0)) == 2


def test_the_angle_is_pitch_less_that_of_the_path_and_none_at_a_standstill():
    speed, theta = np.array([20.0, 3.9]), np.array([0.1, 0.1])
    alpha = derived_alpha(np.array([1.0, 0.0]), speed, theta, np.zeros(2))
    assert alpha[0] == pytest.approx(0.1 - np.arcsin(0.05))
    assert np.isnan(alpha[1])
