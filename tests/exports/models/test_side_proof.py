"""``advisor gap --axis lateral --prove``: roll and yaw of the improved simulator on unseen manoeuvres."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.axis_flown import SideCompared
from advisor.exports.models.axes import prove_side as side_proof
from advisor.exports.models.axes.prove_side import _ahead, prove_side
from advisor.exports.models.proof import NUMBERS, Proof, stays_of
from advisor.gap.result import Diagnosis, Gap
from advisor.oem.estimate import ChannelFit
from tests.gap.axis.test_comparison import AIRCRAFT, TRUE, maneuvers
from tests.gap.axis.test_diagnosis import FOUND
from tests.oem.axis.builders import JET

OFF = {"L_delta_a": 0.6 * JET["L_delta_a"], "N_delta_r": 1.5 * JET["N_delta_r"]}
WEAK = replace(AIRCRAFT, model=TRUE | OFF)


PROOF = Proof(
    maneuvers=(2, 3), before=2.0, after=1.0, floor={}, by_maneuver=(), first="x", second="none", sentence="",
    parts=("aileron_actuator_backlash", NUMBERS),
    not_carried=(), taken_back=("aileron_actuator_backlash",), gap_with_them=3.0,
)  # fmt: skip


def stays(*taken: str) -> Diagnosis:
    return stays_of(replace(PROOF, taken_back=taken), FOUND, JET)


def test_an_effect_that_raises_the_gap_of_the_proof_leaves_the_file_and_keeps_its_probability():
    found = stays("aileron_actuator_backlash")
    assert found.verdict == "effect"
    assert found.probabilities == FOUND.probabilities
    assert not any(cause.present for cause in found.causes)
    assert found.improves
    assert found.sentence.endswith(
        "Taken back: aileron actuator backlash, with which the gap is 3 instead of 1 on manoeuvres 2, 3, "
        "which no fit has used."
    )


def test_where_the_numbers_raise_it_as_well_no_improved_simulator_is_offered():
    found = stays("aileron_actuator_backlash", NUMBERS)
    assert found.verdict == "effect"
    assert not found.improves
    assert "Taken back: aileron actuator backlash and the fitted numbers," in found.sentence


@pytest.mark.parametrize(("after", "taken"), [(0.5, ()), (3.0, (NUMBERS,))])
def test_numbers_with_which_the_gap_grows_on_the_proof_are_taken_back(monkeypatch, after, taken):
    """Manoeuvres of an estimate that says nothing: the gap before is 2."""
    model = SimpleNamespace(theta=np.ones(15), fits=({},), airspeed_m_s=None)
    plain = Diagnosis(axis="lateral", verdict="parameters", sentence="", gap=Gap(), model={})
    asked = []
    monkeypatch.setattr(side_proof, "estimate_axis", lambda *_: model)
    monkeypatch.setattr(side_proof, "compare_axis", lambda _, __, one, ___: asked.append(one) or plain)
    improved = replace(AIRCRAFT, model=dict.fromkeys(SIDE_PARAMETERS, 1.0), simulator="linear")
    monkeypatch.setattr(side_proof, "with_derivatives", lambda *_: improved)
    monkeypatch.setattr(side_proof, "_gap", lambda _, __, ___, theta: after if np.all(theta == 1.0) else 2.0)
    flown = [SimpleNamespace(number=n) for n in range(1, 7)]
    aircraft = replace(AIRCRAFT, model=dict.fromkeys(SIDE_PARAMETERS, 7.0))
    made = prove_side(SideCompared(None, None, aircraft, flown))  # type: ignore[arg-type]
    assert made.taken_back == taken
    assert made.after == min(after, 2.0)
    assert (asked[-1] == improved) == (not taken)


def test_the_servo_ahead_of_a_simulator_leaves_out_the_lag_of_the_simulator_itself():
    """The file states 20 ms, the simulator lags by 30 ms, and the flight by 120 ms in all."""
    found = SideControl(lag_s=0.12, delay_s=0.04)
    ahead = _ahead(SideControl(lag_s=0.02), SideControl(lag_s=0.05), found)
    assert (ahead.lag_s, ahead.delay_s) == (pytest.approx(0.09), 0.04)
    # No servo ahead of a simulator makes the simulator quicker.
    assert _ahead(SideControl(lag_s=0.0), SideControl(lag_s=0.15), SideControl(lag_s=0.05)).lag_s == 0.0


def test_the_gap_of_a_prediction_is_relative_to_the_noise_of_the_fit(monkeypatch):
    """A prediction that is wrong by three times the noise states its own error as its noise."""
    t = np.arange(200.0)
    wrong = ChannelFit("p", t, 0.03 * (-1.0) ** t, np.zeros(200), 0.03)
    fitted = SimpleNamespace(fits=({"p": replace(wrong, noise=0.01)},))
    monkeypatch.setattr(side_proof, "predicted", lambda *_: {"p": wrong})
    assert side_proof._gap(None, fitted, AIRCRAFT, np.ones(15)) == pytest.approx(8.0)


@pytest.fixture(scope="module")
def proof():
    """Wrong numbers, found by three manoeuvres and proved on three of the same kinds."""
    flown = maneuvers()
    compared = SideCompared(None, None, WEAK, flown)  # type: ignore[arg-type]
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
