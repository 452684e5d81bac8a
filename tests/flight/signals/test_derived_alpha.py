"""Which VFR_HUD promise an angle of attack by climb rate and air speed."""

import numpy as np
import pytest

from advisor.flight.signals.derived_alpha import derived_alpha, promised
from tests.flight.columns import Wire
from tests.rows import row

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


@row("a rolling aircraft gives no angle and a standing one will", huds(FAST, ROLLS, STANDS), None, [0, 2])
@row("an aircraft below four metres a second gives none", huds((3.9, 10.0)), None, [])
@row("an aircraft above four metres a second gives one", huds((4.1, 10.0)), None, [0])
@row("without a climb rate there is no angle", huds(FAST, climb=True), 20.0, [])
@row("where no air speed is recorded all give an angle", huds(FAST, ROLLS, airspeed=True), None, [0, 1])
@row("where an air speed is stated all give an angle", huds(FAST, ROLLS), 20.0, [0, 1])
def test_the_records_that_promise_an_angle_of_attack(records, stated_m_s, promising):
    assert promised(records, stated_m_s).tolist() == promising


def test_the_angle_is_pitch_less_that_of_the_path_and_none_at_a_standstill():
    speed, theta = np.array([20.0, 3.9]), np.array([0.1, 0.1])
    alpha = derived_alpha(np.array([1.0, 0.0]), speed, theta, np.zeros(2))
    assert alpha[0] == pytest.approx(0.1 - np.arcsin(0.05))
    assert np.isnan(alpha[1])
