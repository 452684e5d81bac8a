"""The improved simulator flies: the flown inputs go through it, and the gap shrinks there too."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft_file.read import load_aircraft
from advisor.cli.group import advisor
from sim.compare import distances
from sim.effects.fitting import flight_of
from sim.effects.terms import problems_with
from sim.linear import RESEARCH_JET
from sim.linear_aircraft import LinearAircraft
from sim.linear_motion import rates
from sim.modelled import modelled_flight
from sim.record import record
from sim.scenario import Scenario, scenario_from

# One diagnosis writes the file that both tests of it read.
pytestmark = pytest.mark.xdist_group("improved simulator")

CAMPAIGN = Path(__file__).parents[2] / "sim" / "scenarios" / "late-command.yaml"


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    """Return a flight with a late command, the simulator without the delay, and the improved one."""
    folder = tmp_path_factory.mktemp("late")
    flight, believed, improved = folder / "flight.tlog", folder / "believed.yaml", folder / "improved.yaml"
    flown = flight_of(scenario_from(yaml.safe_load(CAMPAIGN.read_text())))
    record(flown, flight)
    truth = flown.engine.truth.as_dict()
    assert set(truth) == set(PARAMETERS)
    believed.write_text(
        yaml.safe_dump(
            {
                "name": "believed",
                "elevator": {
                    "calibration": [[1100, -25.0], [1500, 0.0], [1900, 25.0]],
                    "lag_s": 0.0,
                    "delay_s": 0.0,
                },
                "model": {name: float(value) for name, value in truth.items()},
                "reference_airspeed_m_s": 25.0,
            }
        )
    )
    arguments = ["gap", str(flight), "--aircraft", str(believed), "--out", str(improved), "--json"]
    result = CliRunner().invoke(advisor, arguments, standalone_mode=False)
    assert result.exception is None
    return flight, believed, improved


@pytest.mark.study
def test_the_improved_file_holds_the_effect_and_both_programs_read_it(diagnosed):
    _, _, improved = diagnosed
    effects = load_aircraft(improved).effects
    assert effects["transport_delay"]["delay_s"] == pytest.approx(0.06, abs=0.006)


@pytest.mark.study
def test_flying_the_recorded_inputs_through_the_improved_simulator_shrinks_the_gap(diagnosed, tmp_path):
    flight, believed, improved = diagnosed
    apart = {}
    for name, aircraft in (("before", believed), ("after", improved)):
        replay = tmp_path / f"{name}.tlog"
        record(modelled_flight(Scenario(), aircraft, flight), replay)
        apart[name] = {d.channel: d.difference / d.signal for d in distances(flight, replay)}
    for channel in ("alpha", "q"):
        assert apart["after"][channel] < 0.4 * apart["before"][channel]


def test_what_the_air_speed_does_can_be_written_into_a_file_that_flies() -> None:
    assert problems_with({"airspeed_variation": {"change": 0.05}}) == []
    assert problems_with({"airspeed_variation": {"exponent": -0.8}}) == []
    assert problems_with({"airspeed_variation": {"exponent_M": -1.5, "exponent": 0.0}}) == []


@pytest.mark.parametrize("of_moments", [0.0, -1.2])
def test_the_power_of_the_speed_that_a_file_states_is_flown(of_moments: float) -> None:
    faster, record = 1.2, LinearAircraft(RESEARCH_JET, 50.0, 100.0).record.copy()
    record["speed_scaled"], record["speed_power"], record["moment_power"] = 1.0, -0.5, of_moments
    answers = []
    for elevator in (0.0, 0.1):
        x, u, dx = np.zeros(8), np.zeros(8), np.zeros(8)
        u[0], u[4] = elevator, faster * 50.0
        rates(x, u, record, dx)
        answers.append(dx[:2].copy())
    lift, moment = (answers[1] - answers[0]) / 0.1
    assert lift == pytest.approx(RESEARCH_JET.Z_delta_e * faster**0.5)
    assert moment == pytest.approx(RESEARCH_JET.M_delta_e * faster ** (1.5 + of_moments))
