"""A log that breaks the convention of its air speed is found out by the motion."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.simulators.speed_kind import by_the_motion
from tests.simulators.nonlinear import flown

THIN = 1.0605
"""Ratio of the true to the indicated air speed at 1,200 m."""


def logged(maneuver: Maneuver, factor: float, gain: float) -> Maneuver:
    """Return the manoeuvre at 1,200 m, with an air speed that a factor makes wrong."""
    speed, altitude = maneuver.channels["airspeed"], maneuver.channels["altitude"]
    wrong = replace(speed, y=factor * speed.y, gain=gain)
    high = replace(altitude, y=np.full(len(altitude.y), 1200.0))
    return replace(maneuver, channels={**maneuver.channels, "airspeed": wrong, "altitude": high})


@pytest.mark.parametrize(
    ("factor", "gain", "used", "word"),
    [
        (1.0, THIN, 1.0, ""),
        (THIN, THIN, 1.0, "a true one"),
        (1.0 / THIN, 1.0, 1.0, "an indicated one"),
        (1.02, THIN, 1.02, ""),
    ],
    ids=["as the convention says", "true where indicated is expected", "the other way", "a static error"],
)
def test_the_motion_decides_between_true_and_indicated_and_nothing_else(factor, gain, used, word):
    maneuvers = flown(maneuvers=3)
    found = by_the_motion([logged(m, factor, gain) for m in maneuvers], Aircraft())
    ratio = found.maneuvers[0].channels["airspeed"].y / maneuvers[0].channels["airspeed"].y
    assert ratio == pytest.approx(np.full(len(ratio), used), rel=1e-3)
    assert word in found.note
    assert bool(found.note) == bool(word)
