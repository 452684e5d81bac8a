"""A simulator that trims elsewhere than the aircraft is told so, first and in degrees."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.flight.signals.record import Channel
from advisor.gap.records.prepare import prepare
from advisor.simulators.compare import compare
from advisor.simulators.protocol import Condition, Inputs
from advisor.simulators.static_errors import is_off, trim_differences
from tests.simulators.nonlinear import TRIM_RAD, Nonlinear, flown

CALIBRATED = Aircraft(elevator=Elevator(calibration=((1000.0, -25.0), (2000.0, 25.0))))


def trimmed(aircraft: Aircraft, elevator: float, throttle: float):
    """Return the differences to a simulator that trims at these controls, and at the aircraft's alpha."""
    maneuvers = flown(maneuvers=2)
    for i, m in enumerate(maneuvers):
        t = m.channels["q"].t
        setting = Channel("throttle", t, np.full(len(t), 0.5), "test", "measured")
        maneuvers[i] = replace(m, channels={**m.channels, "throttle": setting})
    t = 0.005 * np.arange(100)
    replay = Nonlinear().replay(Condition(25.0), Inputs(t, 0.0 * t))
    replay = replace(replay, trim={"elevator": elevator, "throttle": throttle})
    flights = prepare(maneuvers, aircraft)
    return {d.quantity: d for d in trim_differences(flights, maneuvers, [replay] * 2, aircraft)}


def test_trims_are_means_before_the_first_step():
    found = trimmed(CALIBRATED, 0.03, 0.7)
    assert found["alpha"].aircraft == pytest.approx(TRIM_RAD, abs=5e-4)
    assert not is_off(found["alpha"])
    assert is_off(found["elevator"])
    assert found["throttle"].simulator - found["throttle"].aircraft == pytest.approx(0.2)


def test_an_elevator_without_a_calibration_tells_no_trim():
    assert set(trimmed(Aircraft(), 0.03, 0.7)) == {"alpha", "throttle"}


@pytest.mark.study
def test_flaps_are_told_as_a_trim_before_anything_else():
    class Clean(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            flown = super().replay(condition, inputs, increments)
            more = np.radians(3.4)
            return replace(flown, alpha=flown.alpha + more, theta=flown.theta + more)

    found = compare(flown(maneuvers=4), Clean(), Aircraft()).diagnosis
    assert found.sentence.startswith("The simulator trims at 3.4 deg more angle of attack than the aircraft")
    assert found.verdict in ("none", "parameters")
