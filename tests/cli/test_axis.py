"""``advisor analyze --axis lateral`` on logs without a lateral manoeuvre."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import NOTHING
from advisor.cli.screen import _campaign
from tests.conftest import Advisor
from tests.flights import TWO, recorded

pytestmark = pytest.mark.usefixtures("recorded_analyses")
BIN = Path(__file__).parents[1] / "cases" / "base.bin"


def test_a_log_whose_ailerons_did_not_move_asks_for_aileron_and_rudder_inputs(advisor: Advisor) -> None:
    told = advisor("analyze", BIN, "--axis", "lateral")
    assert told.returncode == 3
    assert "Fly an aileron doublet and a rudder doublet" in told.stderr


def test_the_axis_of_pitch_alone_leaves_out_roll_and_yaw(advisor: Advisor) -> None:
    told = advisor("analyze", recorded("uav", 1.0, maneuvers=TWO), "--axis", "pitch")
    assert told.returncode == 0
    assert "Roll and yaw" not in told.stdout


def test_screens_judge_roll_and_yaw_of_any_aircraft_as_analyze_does():
    assert _campaign(Aircraft(), None, None, (), (), True, NOTHING).state.lateral is not None
