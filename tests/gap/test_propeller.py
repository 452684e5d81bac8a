"""The effect of a propeller on the tail is part of every propeller aircraft, and no gap."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

C172 = """
aircraft: c172p
engine: jsbsim
airspeed_m_s: 50
noise: {alpha_deg: 0.05, pitch_rate_deg_s: 0.15, pitch_deg: 0.05, accelerometer_m_s2: 0.05}
maneuvers: ["3211", "rev", doublet, "rev", "3211", "rev"]
"""


def test_a_tail_in_the_wash_of_the_propeller_is_no_gap_at_any_speed():
    washed = Setup(maneuvers=6, speed_change=0.03, switches={"wash": 0.2}, seed=31)
    assert diagnose(fly(washed), Aircraft()).verdict == "none"


@pytest.mark.parametrize(
    ("effects", "verdict", "named"),
    [("", "untested", None), ("effects: {transport_delay: {delay_s: 0.06}}", "effect", "transport_delay")],
)
def test_another_engines_aircraft_gets_no_other_name_than_what_was_put_into_it(
    tmp_path, effects, verdict, named
):
    (tmp_path / "c172.yaml").write_text(C172 + effects)
    record(flight_of(read_scenario(tmp_path / "c172.yaml")), tmp_path / "c172.tlog")
    found = compare_logs([tmp_path / "c172.tlog"], Aircraft()).diagnosis
    assert found.verdict == verdict
    assert [c.effect for c in found.causes if c.present][:1] == ([named] if named else [])
