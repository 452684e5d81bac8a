"""Rolling in sideslip turns the angle of attack without a force, in the diagnosis too."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.record import Channel
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_unfiltered
from advisor.gap.simulator.layout import SLIP, SLOW
from advisor.oem.prepare import sideslip_turn, signal_of
from tests.gap.generator import Setup, fly

ROLL_RAD_S, SLIP_RAD, AT_RAD_S = 0.4, 0.07, 3.0


def _rolling() -> list:
    """Manoeuvres in which the aircraft rolls in sideslip, with α turned by it."""
    rolled = []
    for m in fly(Setup(maneuvers=2)):
        t = m.channels["alpha"].t
        course = np.sin(AT_RAD_S * t), np.sin(AT_RAD_S * t + 1.0)
        channels = {
            name: Channel(name, t, y)
            for name, y in (("p", ROLL_RAD_S * course[0]), ("beta", SLIP_RAD * course[1]))
        }
        rolled.append(replace(m, channels={**m.channels, **channels}))
    return rolled


def test_a_record_tells_by_how_much_rolling_in_sideslip_turns_the_angle_of_attack() -> None:
    maneuver = _rolling()[0]
    flight = prepare([maneuver], Aircraft()).flights[0]
    turn = sideslip_turn(maneuver.channels, signal_of(maneuver.channels["alpha"]))
    t = flight.started_s + (np.arange(flight.n) + 0.5) * flight.h
    assert flight.slow[SLIP] == pytest.approx(turn.at(t), abs=1e-9)
    assert np.ptp(flight.slow[SLIP]) > 0.5 * ROLL_RAD_S * SLIP_RAD


def test_without_a_sideslip_nothing_turns() -> None:
    flight = prepare(fly(Setup(maneuvers=1)), Aircraft()).flights[0]
    assert len(flight.slow) == len(SLOW)
    assert not np.any(flight.slow[SLIP])


def test_the_turn_moves_the_angle_of_attack_and_its_force_follows() -> None:
    flights = prepare(_rolling(), Aircraft())
    problem, fitted = fit_unfiltered(flights, Aircraft())
    flight = flights.flights[0]
    p = problem.driving(fitted.point)[0]
    others = np.arange(len(flight.slow))[:, None] != SLIP
    still, step = (replace(flight, slow=np.where(others, flight.slow, turn)) for turn in (0.0, 0.02))
    without, turned = (problem.fly_and_read(one, p[None])[:, 0] for one in (still, step))
    rows = {name: problem.flights.channels.index(name) for name in ("alpha", "a_z")}
    sizes = [len(flight.outputs[name].t) for name in problem.flights.channels]
    parts = np.split(turned - without, np.cumsum(sizes)[:-1])
    t = flight.outputs["alpha"].t - flight.outputs["alpha"].t[0]
    early = (t > 0.0) & (t < 0.05)
    assert parts[rows["alpha"]][early] == pytest.approx(0.02 * t[early], abs=2.5e-4)
    assert np.all(parts[rows["a_z"]][flight.outputs["a_z"].t > 1.0] < 0.0)
