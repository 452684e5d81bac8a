"""``advisor gap --axis lateral --prove``: roll and yaw of the improved simulator on unseen manoeuvres."""

from dataclasses import replace

import pytest

from advisor.analysis.side_gap import SideCompared
from advisor.exports.models.roll_and_yaw import prove_side
from tests.oem.lateral_builders import JET
from tests.side_gap.test_comparison import AIRCRAFT, TRUE, maneuvers

OFF = {"L_delta_a": 0.6 * JET["L_delta_a"], "N_delta_r": 1.5 * JET["N_delta_r"]}
WEAK = replace(AIRCRAFT, model=TRUE | OFF)


@pytest.fixture(scope="module")
def proof():
    """Wrong numbers, found by three manoeuvres and proved on three of the same kinds."""
    flown = maneuvers()
    compared = SideCompared(None, None, WEAK, flown, WEAK)  # type: ignore[arg-type]
    return prove_side(compared, [replace(m, number=m.number + 3) for m in flown])


@pytest.mark.study
def test_wrong_numbers_that_some_manoeuvres_show_are_gone_on_the_others(proof):
    assert proof.maneuvers == (4, 5, 6)
    assert proof.before > 10.0
    assert proof.after < 0.5


@pytest.mark.study
def test_asked_again_the_improved_simulator_lacks_nothing(proof):
    assert proof.first == "parameters"
    assert proof.second == "none"
    assert proof.is_closed
