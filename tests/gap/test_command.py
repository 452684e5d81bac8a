"""Between its stamps a command was held or moved on, and half an interval lies between the two readings."""

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.baseline import fit_baseline
from advisor.gap.data import prepare
from advisor.report.gap import maneuvers_of
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.gap.generator import Setup, fly

UAV = """
aircraft: uav
noise: {alpha_deg: 0.05, pitch_rate_deg_s: 0.15, pitch_deg: 0.05, accelerometer_m_s2: 0.05}
maneuvers: ["3211", "rev", doublet, "rev"]
"""


@pytest.mark.parametrize("flown", ["held", "linear"])
def test_a_command_is_read_as_it_was_flown(tmp_path, flown):
    (tmp_path / "uav.yaml").write_text(f"{UAV}input: {flown}\n")
    record(flight_of(read_scenario(tmp_path / "uav.yaml")), tmp_path / "uav.tlog")
    maneuvers = maneuvers_of([tmp_path / "uav.tlog"], Aircraft())
    problem, _ = fit_baseline(prepare(maneuvers, Aircraft()), Aircraft())
    assert problem.held == (flown == "held")


@pytest.mark.parametrize("seed", [1, 2])
def test_a_delay_of_nearly_an_interval_is_not_taken_for_a_held_command_that_is_half_as_late(seed):
    late = Setup(maneuvers=6, switches={"delay": 0.018}, jitter=0.002, seed=seed)
    problem, _ = fit_baseline(prepare(fly(late), Aircraft()), Aircraft())
    assert not problem.held
