"""The improved simulator flies: the flown inputs go through it, and the gap shrinks there too."""

from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from advisor.aircraft import PARAMETERS
from advisor.cli import advisor
from advisor.config import load_aircraft
from sim.compare import distances
from sim.effects.fitting import flight_of
from sim.modelled import modelled_flight
from sim.record import record
from sim.scenario import Scenario, scenario_from

CAMPAIGN = Path(__file__).parents[2] / "sim" / "scenarios" / "late-command.yaml"


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    """A flight with a late command, the simulator that knows nothing of it, and the improved one."""
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


def test_the_improved_file_holds_the_effect_and_both_programs_read_it(
    diagnosed: tuple[Path, Path, Path],
) -> None:
    _, _, improved = diagnosed
    effects = load_aircraft(improved).effects
    assert effects["transport_delay"]["delay_s"] == pytest.approx(0.06, abs=0.006)


def test_flying_the_recorded_inputs_through_the_improved_simulator_shrinks_the_gap(
    diagnosed: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    flight, believed, improved = diagnosed
    apart = {}
    for name, aircraft in (("before", believed), ("after", improved)):
        replay = tmp_path / f"{name}.tlog"
        record(modelled_flight(Scenario(), aircraft, flight), replay)
        apart[name] = {d.channel: d.difference / d.signal for d in distances(flight, replay)}
    for channel in ("alpha", "q"):
        assert apart["after"][channel] < 0.4 * apart["before"][channel]
