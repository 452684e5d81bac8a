"""Aileron, rudder, throttle and mass of a flight reach a simulator that takes them."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import BANK, ENTRIES
from advisor.simulators.as_given import Flying
from advisor.simulators.inputs import other_controls
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import Condition, Inputs
from tests.simulators.nonlinear import Nonlinear, flown

STEPPED = {"aileron": 0.05, "rudder": -0.03, "throttle": 0.2}


def with_controls(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with every control stepped in its middle, from a value of its own."""
    t, middle = maneuver.channels["q"].t, maneuver.span.start_s + 2.0
    stepped = {
        name: Channel(name, t, 0.4 + np.where(t > middle, size, 0.0), "test", "commanded")
        for name, size in STEPPED.items()
    }
    return replace(maneuver, channels={**maneuver.channels, **stepped})


class Witness(Nonlinear):
    """Banks by what the aileron says, and remembers what it was given."""

    def __init__(self) -> None:
        super().__init__()
        object.__setattr__(self, "given", [])

    def replay(self, condition, inputs, increments=None):
        self.given.append((condition, inputs))
        flown = super().replay(condition, inputs, increments)
        bank = -4.0 * np.interp(flown.t, inputs.t, inputs.others.get("aileron", 0.0 * inputs.t))
        return replace(flown, bank=bank)


def flying(simulator: Witness) -> Flying:
    maneuvers = [with_controls(m) for m in flown(maneuvers=1)]
    flights = prepare(maneuvers, Aircraft())
    controls = other_controls(flights.flights, maneuvers)
    return Flying(simulator, flights, {1: 300.0}, controls, 7.0, lambda *_: None)


def test_logged_controls_reach_the_simulator_as_departures_and_the_mass_with_them():
    simulator = Witness()
    flying(simulator).replays(np.zeros((1, len(ENTRIES))), held=False)
    condition, inputs = simulator.given[0]
    assert condition.mass_kg == 7.0
    for name, size in STEPPED.items():
        assert inputs.others[name][0] == pytest.approx(0.0, abs=1e-9)
        assert inputs.others[name][-1] == pytest.approx(size)


def test_a_simulator_that_rolls_away_under_the_pilots_corrections_flies_without_them():
    simulator = Witness()
    replays = flying(simulator).replays(np.zeros((1, len(ENTRIES))), held=False)
    # 0.05 rad of aileron bank it by 0.2 rad, and the aircraft's wings stay level.
    assert set(simulator.given[0][1].others) == set(STEPPED)
    assert set(simulator.given[1][1].others) == {"throttle"}
    assert np.all(replays[0].bank == 0.0)


def test_the_simulators_own_bank_is_that_of_its_surrogate():
    simulator = Witness()
    begun = flying(simulator)
    constant = {"aileron": 0.02 + 0.0 * begun.controls[1]["aileron"]}
    begun = replace(begun, controls={1: constant})
    there = begun.as_flown(begun.replays(np.zeros((1, len(ENTRIES))), held=False))
    assert there[0].slow[BANK] == pytest.approx(np.full(there[0].n, -0.08))


def test_trimmed_controls_and_what_is_taken_pass_from_another_process():
    apart = Isolated("tests.simulators.makeshift:Trimmed", description="Trimmed")
    try:
        assert apart.takes == {"throttle"}
        t = 0.01 * np.arange(10)
        assert apart.replay(Condition(25.0), Inputs(t, 0.0 * t)).trim == {"elevator": -0.02, "throttle": 0.4}
    finally:
        apart.close()
