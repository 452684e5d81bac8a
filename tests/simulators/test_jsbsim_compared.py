"""JSBSim on both sides: an aircraft flies with an effect, and its unchanged model is the simulator."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs
from sim.effects.fitting import flight_of
from sim.flight import Flight
from sim.record import record
from sim.scenario import Maneuver, Scenario

pytest.importorskip("jsbsim")
FOUR = (Maneuver("3211"), Maneuver("rev"), Maneuver("doublet"), Maneuver("3211"))


@pytest.mark.study
def test_noise_that_coloured_instruments_explain_alone_is_no_moving_air(tmp_path):
    log = tmp_path / "j3.tlog"
    record(
        Flight(Scenario(aircraft="J3Cub", engine="jsbsim", seed=7, airspeed_m_s=32.0, height_m=500.0)), log
    )
    assert compare_logs([log], Aircraft(simulator="jsbsim:J3Cub")).diagnosis.verdict == "none"


def diagnosed(folder, **effects: dict[str, float]):
    """Return the diagnosis of a JSBSim Cessna relative to JSBSim's own Cessna."""
    log = folder / "c172p.tlog"
    scenario = Scenario(
        aircraft="c172p",
        engine="jsbsim",
        seed=6,
        height_m=1000.0,
        speed="free",
        maneuvers=FOUR,
        effects=effects,
    )
    record(flight_of(scenario), log)
    return compare_logs([log], Aircraft(simulator="jsbsim:c172p")).diagnosis


@pytest.mark.study
def test_the_unchanged_model_is_right(tmp_path):
    assert diagnosed(tmp_path).verdict in ("none", "parameters")


@pytest.mark.study
def test_a_withheld_delay_is_named_and_the_gap_shrinks_in_jsbsim(tmp_path):
    found = diagnosed(tmp_path, transport_delay={"delay_s": 0.06})
    assert found.causes[0].effect == "transport_delay"
    assert found.causes[0].parameters["delay_s"].value == pytest.approx(0.06, abs=0.01)
    assert found.in_simulator.percent > 90.0
