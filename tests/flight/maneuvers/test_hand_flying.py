"""A slow movement outside of the model's limits is other flying; an abrupt one is a test, however bad."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.hand_flying import flown_elsewhere
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from tests.flight.elevator.elevators import PATTERNS, slewed, steps
from tests.rows import row

DEG = np.radians(1.0)
T = np.arange(0.0, 20.0, 0.02)
PULL = -2.0 * DEG * np.clip((T - 3.0) / 3.0, 0.0, 1.0) * np.clip((15.0 - T) / 3.0, 0.0, 1.0)
TEST = slewed(T, 2.0 * DEG * steps(T, 3.0, 1.5, PATTERNS["3-2-1-1"]), 0.4)
RISING = np.clip((T - 3.0) / 2.0, 0.0, 1.0)
OUTSIDE = {
    "bank": (40.0 * DEG * np.clip((T - 2.5) / 1.5, 0.0, 1.0), "40 deg of bank (limit 30)"),
    "airspeed": (20.0 * (1.0 - 0.3 * RISING), "air speed 30 % from that before (limit 15)"),
    "throttle": (0.4 + 0.5 * RISING, "throttle moved by 50 % (limit 15)"),
    "aileron": (8.0 * DEG * np.sin(T), "aileron moved by 8 deg (limit 5)"),
}


def record(elevator, every=1, **others):
    values = {"elevator": elevator, **others}
    channels = {name: Channel(name, T[::every], y[::every]) for name, y in values.items()}
    shape = ((3.0, -2.0 * DEG), (14.0, 0.0))
    return Maneuver(1, 0, Span(2.0, 3.0, 14.0, 19.0, "pulse", shape, "quiet"), channels, "MANUAL")


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_slow_movement_outside_of_a_limit_is_other_flying(name):
    values, said = OUTSIDE[name]
    how = flown_elsewhere(record(PULL, **{name: values}), Limits())
    assert how is not None
    assert said in how


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_hand_flown_test_outside_of_a_limit_is_a_test(name):
    assert flown_elsewhere(record(TEST, **{name: OUTSIDE[name][0]}), Limits()) is None


INSIDE = {"bank": 10.0 * DEG * RISING, "airspeed": 20.0 - RISING, "throttle": 0.5 + 0.0 * T}
BANKED = {"bank": OUTSIDE["bank"][0]}


@row("within the limits it may be a test", INSIDE, Limits())
@row("the limits are those of the aircraft file", BANKED, Limits(bank_deg=60.0))
@row("an elevator at two hertz does not show whether it moved slowly", BANKED | {"every": 25}, Limits())
def test_a_slow_movement_is_no_other_flying(others, limits):
    assert flown_elsewhere(record(PULL, **others), limits) is None
