"""A simulator that is known by its log: the bundled aircraft with a slow servo, and without."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs, named_simulator
from advisor.analysis.gap_flights import maneuvers_of
from advisor.simulators.by_log import IdentifiedSimulator
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import Scenario


def logged(folder: Path, name: str, seed: int, **effects: dict[str, float]) -> Path:
    """Return a log of the bundled aircraft."""
    path = folder / f"{name}.tlog"
    record(flight_of(Scenario(aircraft="uav", seed=seed, effects=effects)), path)
    return path


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    slow = {"actuator_lag": {"lag_s": 0.12}}
    return logged(folder, "plain", 3), logged(folder, "other", 4), logged(folder, "slow", 5, **slow)


def diagnosed(flight: Path, simulator: Path):
    """Return the diagnosis of a flight relative to the simulator that wrote a log."""
    return compare_logs([flight], Aircraft(simulator=f"log:{simulator}")).diagnosis


@pytest.mark.study
def test_two_logs_of_one_aircraft_show_no_gap_and_the_notes_give_what_was_identified(logs):
    plain, other, _ = logs
    found = diagnosed(plain, other)
    assert found.verdict == "none"
    assert any("M_alpha" in note and "±" in note for note in found.notes)
    assert found.in_simulator.simulator == "the simulator that wrote other.tlog"


@pytest.mark.study
def test_a_lag_that_the_simulators_log_lacks_is_named_and_added_to_the_simulator(logs):
    plain, _, slow = logs
    found = diagnosed(slow, plain)
    assert found.causes[0].effect == "actuator_lag"
    assert found.causes[0].parameters["lag_s"].value == pytest.approx(0.12, abs=0.02)
    assert found.in_simulator.percent > 90.0


@pytest.mark.study
def test_a_servo_that_the_simulators_log_shows_is_the_simulators(logs):
    _, _, slow = logs
    simulator = named_simulator(Aircraft(simulator=f"log:{slow}"))
    assert isinstance(simulator, IdentifiedSimulator)
    shown = simulator.as_file.elevator.lag_s or simulator.as_file.effects["actuator_lag"]["lag_s"]
    assert shown == pytest.approx(0.12, abs=0.02)


@pytest.mark.study
def test_a_lag_that_only_the_simulator_has_is_said_to_be_too_much(logs):
    plain, _, slow = logs
    found = diagnosed(plain, slow)
    assert found.causes[0].effect in ("actuator_lag", "transport_delay")
    assert "too " in found.sentence
    assert len(maneuvers_of([plain], Aircraft()).maneuvers) > 2
