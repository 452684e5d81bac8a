"""A companion computer of the vehicle may send the angle of attack; what is used is said."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.channels import COMPANION_ALPHA
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, aoa, attitude, heartbeat, hud, servo

COMPANION, OTHER_SYSTEM = {"component": 191}, {"system": 7}


def streamed(*senders: dict[str, int]) -> FlightStream:
    """Ten seconds of a vehicle whose angle of attack comes from these senders."""
    wire = Wire()
    heartbeat(wire, 1000.0)
    for k, at in enumerate(np.arange(1000.1, 1010.0, 0.02).tolist()):
        attitude(wire, at, at - 900.0)
        servo(wire, at + 1e-4, at - 900.0, {2: 1500})
        hud(wire, at + 2e-4)
        for sender in senders:
            aoa(wire, at + 3e-4, at - 900.0, 2.0 + 0.1 * (k % 7) + sender.get("component", 1), **sender)
    stream = FlightStream(Aircraft())
    stream.feed(wire.columns())
    return stream


def test_a_companions_angle_of_attack_is_used_and_named() -> None:
    status = streamed(COMPANION).channels["alpha"]
    assert status.source == COMPANION_ALPHA
    assert status.provenance == "unknown"
    assert status.rate_hz == pytest.approx(50.0, rel=0.02)


def test_the_autopilots_own_angle_of_attack_goes_before_a_companions() -> None:
    assert streamed(COMPANION, {}).channels["alpha"].source == "AOA_SSA.AOA"


def test_the_angle_of_attack_of_another_vehicle_is_not_used() -> None:
    assert streamed(OTHER_SYSTEM).channels["alpha"].provenance == "derived"
